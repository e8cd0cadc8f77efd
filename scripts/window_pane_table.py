"""window_pane_table.py OUT DOC: a window pane, ricochet beside a peer, as a table of DOC; see scripts/window-pane."""

import sys
from pathlib import Path

from markers import replace, table
from meshed_table import first_contact, of_ricochet, peers, per_cent, seconds

HITS = {"centre": "at the centre", "off": "at (0.13, 0.21) m from it"}
HEAD = ["program", "hit", "unknowns", "vectors", "time", "error (estimate)"]


def main():
    out, document = Path(sys.argv[1]), sys.argv[2]
    rows, references = [], {}
    for name, hit in HITS.items():
        _, reference = of_ricochet(out / f"{name}-1e-3.h5")
        references[name] = reference, first_contact(reference.time, reference.acceleration)
        facts, own = of_ricochet(out / f"{name}-1e-2.h5")
        error, estimate = own.error(*references[name]), float(facts["first_contact_error"])
        numbers = [f"{int(facts['unknowns']):,}", facts["reduction"].decode().split()[0], seconds(float(facts["wall_time_total"]))]
        rows.append(["ricochet", hit, *numbers, f"{per_cent(error)} ({per_cent(estimate)})"])
    for vectors, time, history in sorted(peers(out / "peer"), key=lambda run: run[0]):
        rows.append(["peer", HITS["centre"], "", vectors, seconds(time), per_cent(history.error(*references["centre"]))])
    replace(document, "window-pane", table(HEAD, rows))


if __name__ == "__main__":
    main()

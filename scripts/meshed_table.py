"""meshed_table.py OUT DOC: bodies on meshes, ricochet beside the quickest peer, as a table of DOC; see scripts/meshed."""

import csv
import sys
from pathlib import Path

import h5py
import numpy as np

from markers import replace, table

BODIES = {"hole": "round plate with a hole", "cylinder": "cylinder"}
TOLERANCE = 1e-2
HEAD = ["body", "mesh", "unknowns", "vectors", "ricochet", "its error (estimate)", "peer: vectors", "time", "error", "over ricochet's"]


def first_contact(time, acceleration):
    """Up to the first time at which the force is zero again."""
    after = np.flatnonzero((acceleration <= 0) & (time > time[np.argmax(acceleration > 0)]))
    return time[after[0]] if len(after) else time[-1]


class History:
    """Times (s) and accelerations (m/s2)."""

    def __init__(self, time, acceleration):
        self.time, self.acceleration = time, acceleration

    def error(self, reference, end):
        """Largest difference from a finer history at this one's steps up to a time, over the peak, as `ricochet chart` has it."""
        until = self.time <= end
        difference = self.acceleration[until] - cubic(self.time[until], reference.time, reference.acceleration)
        return np.abs(difference).max() / reference.acceleration.max(where=reference.time <= end, initial=0)


def cubic(at, x, y):
    """Cubics through two points on either side; where the contact opens or closes, straight lines."""
    x, keep = np.unique(x, return_index=True)
    y = y[keep]
    i = np.clip(np.searchsorted(x, at) - 2, 0, len(x) - 4)
    around, values = x[i[:, None] + np.arange(4)], y[i[:, None] + np.arange(4)]
    total = np.zeros(len(at))
    for n in range(4):
        others = [m for m in range(4) if m != n]
        total += values[:, n] * np.prod([(at - around[:, m]) / (around[:, n] - around[:, m]) for m in others], axis=0)
    return np.where((values > 0).all(axis=1), total, np.interp(at, x, y))


def peers(folder):
    """Rows of a table of peers with their histories: setting, vectors, seconds, history."""
    with (folder / "peers.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        series = np.loadtxt(folder / row["series"], delimiter=",", skiprows=1)
        vectors = next(int(part.split()[0]) for part in row["setting"].split(", ") if part.endswith(" vectors"))
        yield vectors, float(row["build"]) + float(row["run"]), History(series[:, 0], series[:, 1])


def of_ricochet(path):
    """Attributes and history of a result."""
    with h5py.File(path) as file:
        facts = dict(file.attrs)
        return facts, History(file["series/time"][:], file["series/impactor/acceleration"][:])


def seconds(value):
    return f"{value:.2g} s" if value < 9.95 else f"{value:.0f} s"


def per_cent(value):
    return f"{100 * value:.2g}%"


def line(name, mesh, folder):
    """A row: ricochet at its tolerance, and the quickest of the peer's runs within it."""
    *runs, (_, _, reference) = sorted(peers(folder), key=lambda run: run[0])
    end = first_contact(reference.time, reference.acceleration)
    facts, own = of_ricochet(folder / "ricochet-1e-2.h5")
    within = [(vectors, time, error) for vectors, time, history in runs if (error := history.error(reference, end)) <= TOLERANCE]
    total = float(facts["wall_time_total"])
    estimate = float(facts["first_contact_error"])
    row = [name, mesh, f"{int(facts['unknowns']):,}", facts["reduction"].decode().split()[0], seconds(total)]
    row.append(f"{per_cent(own.error(reference, end))} ({per_cent(estimate)})")
    if not within:
        return row + [f"up to {runs[-1][0]}", f"over {seconds(runs[-1][1])}", per_cent(runs[-1][2].error(reference, end)), "–"]
    vectors, time, error = min(within, key=lambda run: run[1])
    return row + [vectors, seconds(time), per_cent(error), f"{time / total:.2g}"]


def main():
    out, document = Path(sys.argv[1]), sys.argv[2]
    rows = []
    folders = [folder for folder in out.iterdir() if folder.is_dir()]
    for folder in sorted(folders, key=lambda folder: (list(BODIES).index(folder.name.split("-")[0]), folder.name)):
        body, *mesh = folder.name.split("-")
        rows.append(line(BODIES[body], mesh[0], folder))
    replace(document, "meshed", table(HEAD, rows))


if __name__ == "__main__":
    main()

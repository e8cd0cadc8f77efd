"""charts_table.py OUT DOC: what scripts/charts computed into OUT as tables of DOC.

OUT holds PLATE-kK/work-precision.csv.
"""

import csv
import sys

from markers import replace, table

PLATES = {"plate100": "1.5 × 1.5 × 0.1 m", "plate40": "1.5 × 1.5 × 0.04 m", "plate20": "0.5 × 0.5 × 0.02 m"}
STIFFNESSES = ["0", "1e9"]
LEVELS = [1e-1, 5e-2, 2e-2, 1e-2, 5e-3, 2e-3, 1e-3, 1e-4]
TENSION_LEVELS = [5e-2, 2e-2, 1e-2, 5e-3]
# Methods whose small errors on these plates are accidental.
ACCIDENTAL = ["half-space", "infinite-plate"]
LISTING = "legacy FEniCS, the paper's listing"
PEERS = {LISTING: "the listing", "legacy FEniCS, condensed": "FEniCS, condensed",
         "NGSolve + eigsh modes": "NGSolve, modes", "NGSolve + Ritz vectors": "NGSolve, Ritz"}  # fmt: skip


def points(path, error):
    with open(path, encoding="utf-8") as file:
        for row in csv.DictReader(file):
            yield row["method"], row["setting"], float(row["total_s"]), float(row[error]), row["is_resolved"] == "true"


def best(rows, level):
    fit = [row for row in rows if row[3] <= level]
    return min(fit, key=lambda row: row[2]) if fit else None


def seconds(value):
    return f"{1e3 * value:.2g} ms" if value < 0.0995 else f"{1e3 * value:.0f} ms" if value < 1 else f"{value:.1f} s"


def per_cent(level):
    return f"{100 * level:g}%"


def ratio(value):
    return f"{value:.1f}" if value < 10 else f"{value:,.0f}"


def chart(rows, levels, columns):
    """By error: our best, auto's, and over ours those of the peers, each with the head of its column."""
    peers, auto = [row for row in rows if row[0] in columns], [row for row in rows if row[0] == "auto"]
    own = [row for row in rows if row[0] not in columns and row[0] != "auto"]
    counted = [row for row in own if row[0] not in ACCIDENTAL]
    lines = []
    # Errors that the reference cannot tell are below this.
    floor = max((row[3] for row in rows if not row[4]), default=0.0)
    for level in levels:
        first = best(own, level)
        if first is None or level < floor:
            lines.append([per_cent(level), *["–"] * (2 + len(columns))])
            continue
        asked = [row for row in auto if row[1] == f"accuracy.tolerance={level:.0e}".replace("e-0", "e-")]
        of_auto = "–"
        if asked:
            met = "" if asked[0][3] <= level else ", **missed**"
            of_auto = f"{seconds(asked[0][2])}, {ratio(asked[0][2] / first[2])} times; error {100 * asked[0][3]:.2g}%{met}"
            front = best(counted, asked[0][3])
            if front and asked[0][4]:
                of_auto += f", {ratio(asked[0][2] / front[2])} times the quickest run within its error"
        cells = []
        for name in columns:
            point = best([row for row in peers if row[0] == name], level)
            cells.append(f"{ratio(point[2] / first[2])} ({seconds(point[2])})" if point else "–")
        lines.append([per_cent(level), f"{first[0]} {first[1]}, {seconds(first[2])}", of_auto, *cells])
    return table(["error", "quickest", "`auto`, over it", *columns.values()], lines)


def tension(rows):
    """The same by the error of the largest tension, whatever the acceleration's is."""
    return chart([(method, setting, time, error, True) for method, setting, time, error, _ in rows], TENSION_LEVELS, PEERS)


def main(folder, doc):
    for plate in PLATES:
        for k in STIFFNESSES:
            of_chart = f"{folder}/{plate}-k{k}/work-precision.csv"
            replace(doc, f"chart-{plate}-k{k}", chart(list(points(of_chart, "error_first")), LEVELS, PEERS))
            replace(doc, f"tension-{plate}-k{k}", tension(list(points(of_chart, "error_tension"))))


if __name__ == "__main__":
    main(*sys.argv[1:])

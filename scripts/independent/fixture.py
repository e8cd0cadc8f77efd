"""fixture.py OUTDIR CASE: computes the first contact of a case and writes OUTDIR/CASE.csv and OUTDIR/CASE.json, its error's parts."""

import json
import sys
import time
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np

from cases import CASES
from impact import AFTER, Steps, acceleration, first_contact, limit, thinned
from quarter import Cells, Quarter
from reduced import Reduced

RADII = [1 / 8, 1 / 6, 1 / 4]  # of the patches, over the thickness; the first has the most vectors
CELLS = Cells(order=4, first=1 / 14, growth=0.55, largest=2.0, last=0.4, layers=(4, 3, 2, 1))
FAR = replace(CELLS, growth=0.7, largest=3.0)  # off both axes, where more cells are fine and four classes are to be solved
MANY, FEW = 160, 8  # vectors; one of several classes has but a part of the modes
OF_SEVERAL = 100
INTERPOLATED = 1e-4  # of the peak: what the rows may leave


def chosen(case):
    """Cells, and the number of vectors of each class of symmetry."""
    count = len(case.parities)
    return FAR if count == 4 else CELLS, MANY if count == 1 else OF_SEVERAL


def reduce(case, order, many):
    """All classes of symmetry; and unknowns."""
    radii = [radius * case.scene.size[2] for radius in RADII]
    classes, unknowns = [], 0
    for quarter in Quarter.classes(case, replace(chosen(case)[0], order=order), radii):
        classes.append(Reduced.on_vectors(quarter, many, FEW))
        unknowns += quarter.loads.shape[0]
    return classes, unknowns


def series(case, classes, steps, numbers=(2, 0)):
    """The limit of small patches from two radii."""
    radii = [RADII[number] * case.scene.size[2] for number in numbers]
    return limit(radii, [acceleration(case, classes, number, r, steps) for number, r in zip(numbers, radii, strict=True)])


def remaining(first, second):
    """What two changes, one after the other, leave if the next ones go on falling by their ratio; at most the second itself."""
    return second * min(1.0, second / max(first - second, 1e-3 * second))


def halves(classes):
    """The same on half of the vectors."""
    return [reduced.half() for reduced in classes]


def main(folder, name):
    begin = time.process_time()
    case, steps = CASES[name], Steps()
    cells, many = chosen(case)
    classes, unknowns = reduce(case, cells.order, many)
    answer = series(case, classes, steps)
    small = acceleration(case, classes, 0, RADII[0] * case.scene.size[2], steps)
    last = first_contact(small)
    peak = np.max(answer[: last + 1])

    def change(one, other):
        """Largest difference in the first contact, over its peak."""
        return float(np.max(np.abs(one[: last + 1] - other[: last + 1])) / peak)

    orders = [series(case, reduce(case, cells.order - less, many // 2)[0], steps) for less in (2, 1)]
    half = halves(classes)
    vectors = [series(case, fewer, steps) for fewer in (halves(half), half)]
    double = series(case, classes, replace(steps, length=2 * steps.length))
    squares = np.square(RADII)
    changes = {
        "order": (change(*orders), change(orders[1], vectors[1])),  # on half of the vectors, all three
        "vectors": (change(*vectors), change(vectors[1], answer)),
        "patch": change(series(case, classes, steps, (1, 0)), answer),
    }
    parts = {
        "cells": remaining(*changes["order"]),
        "vectors": remaining(*changes["vectors"]),
        "step": float(np.max(np.abs(double[: last // 2] - answer[:last:2][: last // 2])) / peak / 3),  # of second order
        # The frequencies beyond are those of waves across the thickness, which the cells away from the hit are too large for.
        "springs": change(series(case, classes, replace(steps, springs=steps.springs * 2)), answer),
        # What is left goes with the product of the squares of the two radii: so the two limits are this apart.
        "patch": changes["patch"] * squares[2] / (squares[2] - squares[1]),
    }
    times = steps.length * np.arange(len(answer))
    rows, values, parts["rows"] = thinned(times, answer, AFTER * times[last], INTERPOLATED)
    np.savetxt(folder / f"{name}.csv", np.column_stack([rows, values]), fmt=["%.7e", "%.6e"], delimiter=",",
               header="time,acceleration", comments="")  # fmt: skip
    found = {
        "peak": float(peak),
        "end": float(times[last]),
        "unknowns": unknowns,
        "changes": changes,
        "parts": parts,
        "error": sum(parts.values()),
        "smallest_patch": change(small, answer),
        "rows": len(rows),
        "cells": asdict(cells),
        "seconds": time.process_time() - begin,
    }
    (folder / f"{name}.json").write_text(json.dumps(found, indent=1), encoding="utf-8")
    print(name, json.dumps(found), flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2])

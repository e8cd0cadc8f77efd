"""The first contact on a laminated pane that relaxes: tests/fixtures/laminated/finer.csv.

    PYTHONPATH=scripts/peers $(scripts/peers/python) scripts/independent/laminated_pane.py scenes/laminate.toml tests/fixtures/laminated/finer.csv

Layers and materials are those of the scene; pane and impact are those of tests/fixtures/laminated/series.csv. Columns: time (s), force (N). A quarter of
hexahedra of high order on load-dependent Ritz vectors, Newmark's average acceleration with Maxwell terms. Its own error, printed, is what hexahedra
of one order less, two thirds of the vectors and twice the step change, over the peak of the force.
"""

import sys
from dataclasses import replace
from pathlib import Path

import ngsolve
import numpy as np

import laminate_ritz
import relaxing
from contact import Impactor
from layers import read_layers
from scene import Cells, Scene
from solid import Solid

SIZE = (0.5, 0.5, 0.02076)
END = 3e-3
EVERY = 2e-5  # s, between rows
PATCH = 2.5e-3
# Plies in two or three cells, the interlayer in one.
CELLS = Cells(4, PATCH / SIZE[2], 0.15, 0.7, 1.5, 0.7, (0.5, 0.5, 0.076, 0.5, 0.5))
VECTORS, STEP = 240, 1e-6


def forces(scene, cells, vectors, step):
    """At the times of the rows, N."""
    system, solve = laminate_ritz.prepare(Solid.build(scene, cells), scene.chain, step, vectors)
    impactor = Impactor.quarter(scene, cells.patch * scene.size[2])
    _, accelerations, _ = relaxing.history(system, solve, impactor, scene.chain, scene.end, step)
    return scene.mass * accelerations[:: round(EVERY / step)]


def main():
    source, result = map(Path, sys.argv[1:])
    ngsolve.SetNumThreads(1)
    scene = Scene(SIZE, 0.0, END, plies=read_layers(source, SIZE[2]))
    own = forces(scene, CELLS, VECTORS, STEP)
    others = {
        "order": (replace(CELLS, order=CELLS.order - 1), VECTORS, STEP),
        "vectors": (CELLS, 2 * VECTORS // 3, STEP),
        "step": (CELLS, VECTORS, 2 * STEP),
    }
    for name, choice in others.items():
        print(f"{name}: {np.abs(forces(scene, *choice) - own).max() / own.max():.1e} of the peak", flush=True)
    rows = np.column_stack([EVERY * np.arange(len(own)), own])[1:]
    np.savetxt(result, rows, fmt=["%g", "%.2f"], delimiter=",", header="t,F", comments="")


if __name__ == "__main__":
    main()

"""What the two peers on a basis share: their settings, and how they are timed."""

import ngsolve

import modal
import points
from contact import Impactor
from scene import Cells, arguments, short
from solid import Solid

ngsolve.SetNumThreads(1)

TINY = Cells(2, 0.25, 5, 1, 5, 5)  # for compiling


def build(scene, cells, reduce, count, step):
    """All before the first step; what it returns takes the steps.

    reduce(solid, count) gives omega^2 (1/s2), phi (kg^-0.5) and two normal stresses (Pa kg^-0.5 / m) of each mode.
    """
    basis = reduce(Solid.build(scene, cells), count)
    impactor = Impactor.quarter(scene, cells.patch * scene.size[2])
    return lambda: modal.history(basis, impactor, scene.end, step)


def main(doc, name, reduce, noun, choices):
    """Adds to the table the points of the peer `name` at its choices: cells, number of vectors, step (s)."""
    scene, folder, budget = arguments(doc)
    collect(scene, folder, budget, name, reduce, noun, choices)


def collect(scene, folder, budget, name, reduce, noun, choices):
    """The same of a scene that is given."""
    build(scene, TINY, reduce, 3, scene.end / 10)()
    settings = []
    for cells, count, step in choices:
        counts = "×".join(str(len(line) - 1) for line in cells.lines(scene))
        text = f"{counts} Q{cells.order} of a quarter, r_p {cells.patch:.2g} h, {count} {noun}, Δt {short(step)}"
        measure = lambda c=cells, n=count, s=step: points.timed(lambda: build(scene, c, reduce, n, s))
        settings.append((text, measure))
    points.collect(name, settings, folder, budget)

"""Peer: NGSolve's matrices of a laminated pane, all unknowns by Newmark's method with Maxwell terms, CHOLMOD's factor."""

import relaxing
from scene import Cells

NAME = "NGSolve + Newmark"
# From the bottom: plies in one, two or three cells, the interlayer in one.
COARSE, FINE = (1, 0.076, 1), (0.5, 0.5, 0.076, 0.5, 0.5)
FINEST = (0.5, 0.5, 0.076, 1 / 3, 1 / 3, 1 / 3)
SETTINGS = [  # cells, step (s)
    (Cells(2, 0.2, 0.5, 1, 2, 2, COARSE), 2e-5),
    (Cells(3, 0.2, 0.5, 1, 3, 2, COARSE), 1e-5),
    (Cells(3, 0.2, 0.3, 1, 2, 1, COARSE), 5e-6),
    (Cells(3, 0.2, 0.25, 1, 2, 1, FINE), 4e-6),
    (Cells(3, 0.12, 0.15, 1, 2, 1, FINEST), 4e-6),
]


def prepare(solid, chain, step):
    """The body, and what solves with the matrix of a step."""
    return solid, solid.factor(4 / step**2, chain.moduli @ chain.over(step)[1])


if __name__ == "__main__":
    relaxing.main(__doc__, NAME, prepare, SETTINGS)

"""Peer: NGSolve's matrices of a laminated pane on load-dependent Ritz vectors, Newmark's method with Maxwell terms on these."""

import math
from dataclasses import replace

import numpy as np
import scipy.linalg as dense

import relaxing
from laminate_newmark import COARSE, FINE, FINEST
from python_ritz import FREQUENCY, ritz_vectors
from scene import Cells

NAME = "NGSolve + Ritz vectors, relaxing"
SETTINGS = [  # cells, step (s), vectors
    (Cells(2, 0.2, 0.5, 1, 2, 2, COARSE), 2e-5, 20),
    (Cells(3, 0.2, 0.5, 1, 3, 2, COARSE), 1e-5, 30),
    (Cells(3, 0.2, 0.5, 1, 3, 2, COARSE), 4e-6, 60),
    (Cells(3, 0.2, 0.3, 1, 2, 1, COARSE), 4e-6, 60),
    (Cells(3, 0.2, 0.25, 1, 2, 1, FINE), 4e-6, 60),
    (Cells(3, 0.2, 0.25, 1, 2, 1, FINE), 4e-6, 120),
    (Cells(3, 0.12, 0.15, 1, 2, 1, FINEST), 4e-6, 120),
]


def prepare(solid, chain, step, count):
    """The body on vectors that are made with the modulus at their rate, and what solves with the matrix of a step."""
    rate = 2 * math.pi * FREQUENCY
    basis = ritz_vectors(solid, solid.factor(rate**2, chain.at_rate(rate)), count)
    project = lambda matrix: basis.T @ (matrix @ basis)
    reduced = replace(
        solid,
        stiffness=project(solid.stiffness),
        distortion=project(solid.distortion),
        mass=np.eye(count),
        load=basis.T @ solid.load,
        stresses=solid.stresses @ basis,
    )
    modulus = chain.moduli @ chain.over(step)[1]
    factor = dense.cho_factor(reduced.stiffness + modulus * reduced.distortion + 4 / step**2 * reduced.mass)
    inverse = dense.cho_solve(factor, np.eye(count))
    return reduced, lambda b: inverse @ b


if __name__ == "__main__":
    relaxing.main(__doc__, NAME, prepare, SETTINGS)

"""Peer: NGSolve's matrices, modes by SciPy's eigsh (shift-invert by CHOLMOD), a residual vector, numba."""

import math

import numpy as np
from scipy.sparse.linalg import LinearOperator, eigsh

import bases
from scene import Cells

NAME = "NGSolve + eigsh modes"
SETTINGS = [  # cells, modes, step (s)
    (Cells(3, 0.25, 0.5, 1, 6, 1.5), 20, 4e-6),
    (Cells(3, 0.25, 0.5, 1, 4, 1), 40, 2e-6),
    (Cells(4, 0.25, 0.5, 1, 6, 1), 40, 2e-6),
    (Cells(4, 0.25, 0.5, 1, 6, 1), 80, 2e-6),
    (Cells(4, 0.25, 0.25, 1, 4, 1, (2, 1)), 80, 1e-6),
    (Cells(4, 0.25, 0.25, 1, 4, 1, (2, 1)), 160, 1e-6),
    (Cells(4, 1 / 6, 1 / 6, 1, 4, 1, (3, 2, 1)), 160, 5e-7),
    (Cells(4, 1 / 6, 1 / 6, 0.8, 3, 0.5, (3, 2, 1)), 160, 5e-7),
]
FREQUENCY = 50.0  # Hz: shift below zero, so that the matrix of a free plate is definite


def modes(solid, count):
    """omega^2 (1/s2), phi (kg^-0.5) and stresses of the lowest modes, and of one vector of static correction.

    The correction is what the modes miss of the displacement by a force of one: orthogonal to them, so a mode of its own.
    """
    shift = (2 * math.pi * FREQUENCY) ** 2
    factor = solid.factor(shift)
    inverse = LinearOperator(solid.mass.shape, matvec=factor, dtype=float)
    start = factor(solid.load)  # holds all modes that the impact excites
    squares, vectors = eigsh(solid.stiffness, count, solid.mass, sigma=-shift, OPinv=inverse, v0=start, tol=1e-6)
    shapes = vectors.T @ solid.load
    residual = start - vectors @ (shapes / (squares + shift))
    norm = residual @ (solid.mass @ residual)
    return (
        np.append(squares, residual @ (solid.stiffness @ residual) / norm),
        np.append(shapes, residual @ solid.load / math.sqrt(norm)),
        np.column_stack([solid.stresses @ vectors, solid.stresses @ residual / math.sqrt(norm)]),
    )


if __name__ == "__main__":
    bases.main(__doc__, NAME, modes, "modes", SETTINGS)

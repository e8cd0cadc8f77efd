"""Peer: NGSolve's matrices on load-dependent Ritz vectors (Wilson, Yuan and Dickens, 1982), in SciPy and numba."""

import math

import numpy as np
import scipy.linalg as dense

import bases
from scene import Cells

NAME = "NGSolve + Ritz vectors"
SETTINGS = [  # cells, vectors, step (s)
    (Cells(3, 0.25, 0.5, 1, 6, 1.5), 20, 4e-6),
    (Cells(3, 0.25, 0.5, 1, 4, 1), 30, 2e-6),
    (Cells(4, 0.25, 0.5, 1, 6, 1), 40, 2e-6),
    (Cells(4, 0.25, 0.5, 0.5, 6, 1), 40, 2e-6),
    (Cells(4, 0.25, 0.25, 1, 4, 1, (2, 1)), 40, 1e-6),
    (Cells(4, 0.25, 0.25, 1, 4, 1, (2, 1)), 80, 1e-6),
    (Cells(4, 1 / 6, 1 / 6, 1, 4, 1, (3, 2, 1)), 80, 5e-7),
    (Cells(4, 1 / 6, 1 / 6, 0.8, 3, 0.5, (3, 2, 1)), 100, 5e-7),
    (Cells(5, 1 / 6, 1 / 6, 1, 4, 0.5, (3, 2, 1)), 120, 5e-7),
]
FREQUENCY = 1000.0  # Hz: shift of the vectors, which also holds the rigid-body modes of a free plate


def ritz_vectors(solid, factor, count):
    """S^-1 a, S^-1 M S^-1 a, …, orthonormal in M; factor(b) gives S^-1 b."""
    basis = np.empty((len(solid.load), count), order="F")
    vector = factor(solid.load)
    for number in range(count):
        earlier = basis[:, :number]
        weighted = solid.mass @ vector
        for _ in range(2):  # twice is enough
            vector -= earlier @ (earlier.T @ weighted)
            weighted = solid.mass @ vector
        norm = math.sqrt(vector @ weighted)
        basis[:, number] = vector / norm
        vector = factor(weighted / norm)
    return basis


def ritz_modes(solid, count):
    """omega^2 (1/s2), phi (kg^-0.5) and stresses of the modes on `count` vectors with S = K + s M."""
    basis = ritz_vectors(solid, solid.factor((2 * math.pi * FREQUENCY) ** 2), count)
    squares, modes = dense.eigh(basis.T @ (solid.stiffness @ basis))
    return squares, modes.T @ (basis.T @ solid.load), (solid.stresses @ basis) @ modes


if __name__ == "__main__":
    bases.main(__doc__, NAME, ritz_modes, "vectors", SETTINGS)

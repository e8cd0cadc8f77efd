"""Peer: NGSolve's matrices on load-dependent Ritz vectors (Wilson, Yuan and Dickens, 1982), in SciPy and numba."""

import math

import numpy as np
import scipy.linalg as dense

import modal
from contact import Impactor
from solid import Solid

FREQUENCY = 1000.0  # Hz: shift of the vectors, which also holds the rigid-body modes of a free plate


def ritz_modes(solid, count):
    """omega^2 (1/s2) and phi (kg^-0.5) of the modes on `count` vectors (K + s M)^-1 a, (K + s M)^-1 M (K + s M)^-1 a, …"""
    factor = solid.factor((2 * math.pi * FREQUENCY) ** 2)
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
    squares, modes = dense.eigh(basis.T @ (solid.stiffness @ basis))
    return squares, modes.T @ (basis.T @ solid.load)


def build(scene, cells, count, step):
    """All before the first step; what it returns takes the steps."""
    squares, shapes = ritz_modes(Solid.build(scene, cells), count)
    impactor = Impactor.quarter(scene, cells.patch * scene.size[2])
    return lambda: modal.history(squares, shapes, impactor, scene.end, step)

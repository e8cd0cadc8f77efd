"""Hertz's pressure over a disc, integrated exactly against functions that are polynomials on each cell of a tensor grid."""

import math

import numpy as np

NODES, WEIGHTS = (part / 2 for part in np.polynomial.legendre.leggauss(12))
NODES = NODES + 0.5


def rule(radius, place, lines):
    """Points (n, 2) in the disc's own cells, and weights of sum one.

    With x = r sin(theta) and y = r cos(theta) sin(psi) from the centre `place`, the pressure of a total force of one,
    3 / (2 pi r^2) sqrt(1 - (x^2 + y^2) / r^2) dx dy, is 3 / (2 pi) cos^3(theta) cos^2(psi) dpsi dtheta, which is smooth. Both
    angles are cut where a line of the grid, `lines` along x and along y, crosses the disc.
    """
    along, across = ((line - centre) / radius for line, centre in zip(lines, place, strict=True))
    # Where the disc's edge crosses a line of constant y, the number of pieces in psi changes.
    edge = np.sqrt(1 - across[np.abs(across) < 1] ** 2)
    points, weights = [], []
    for theta, d_theta in pieces(np.arcsin(np.clip(np.concatenate([along, edge, -edge]), -1, 1))):
        for psi, d_psi in pieces(np.arcsin(np.clip(across / math.cos(theta), -1, 1))):
            points.append((math.sin(theta), math.cos(theta) * math.sin(psi)))
            weights.append(1.5 / math.pi * math.cos(theta) ** 3 * math.cos(psi) ** 2 * d_theta * d_psi)
    return np.array(place) + radius * np.array(points), np.array(weights)


def pieces(cuts):
    """Gauss's points and weights on each piece of [-pi/2, pi/2] between the cuts."""
    ends = np.unique(np.concatenate([[-math.pi / 2], np.sort(cuts), [math.pi / 2]]))
    for low, high in zip(ends, ends[1:]):
        if high - low > 1e-9:
            yield from zip(low + (high - low) * NODES, (high - low) * WEIGHTS)

"""The contact of a quarter model: the impactor, Hertz's law in a step, the patch. SI units."""

import math
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Impactor:
    """What a model sees of the impactor; of a quarter model mass, k0 and force are a quarter of the whole ones, and c is four times it."""

    mass: float
    hertz: float
    dent: float
    speed: float

    @classmethod
    def whole(cls, scene, patch):
        return cls(scene.mass, scene.hertz_stiffness, scene.dent(patch), scene.speed)

    @classmethod
    def quarter(cls, scene, patch):
        return cls(scene.mass / 4, scene.hertz_stiffness / 4, 4 * scene.dent(patch), scene.speed)


def quarter_disc(patch, rule=16):
    """Points (n, 2), m, and weights, of sum one, that integrate with Hertz's pressure over a quarter of the patch.

    With s = sqrt(1 - r^2 / r_p^2) the weight is s^2 ds dphi: a polar rule of Gauss's points in s and phi.
    """
    nodes, weights = np.polynomial.legendre.leggauss(rule)
    nodes, weights = (nodes + 1) / 2, weights / 2
    radii, angles = patch * np.sqrt(1 - nodes**2), nodes * math.pi / 2
    points = np.stack([np.outer(radii, np.cos(angles)), np.outer(radii, np.sin(angles))], axis=-1)
    return points.reshape(-1, 2), np.outer(3 * weights * nodes**2, weights).ravel()


def whole_disc(patch):
    """The same over the whole patch."""
    points, weights = quarter_disc(patch)
    signs = [np.array([i, j]) for i in (1, -1) for j in (1, -1)]
    return np.concatenate([points * sign for sign in signs]), np.tile(weights / 4, 4)


def force(apart, yielding, hertz):
    """F of F = k0 <apart - yielding F>^1.5: Newton's iteration in z = alpha^0.5, inside a bracket."""
    if apart <= 0.0:
        return 0.0
    # For alpha = z^2: z^2 + slope z^3 = apart, which grows with z up to -2 / (3 slope) where slope is negative.
    slope = yielding * hertz
    low, high = 0.0, math.sqrt(apart)
    if slope < 0.0:
        low, high = high, -2.0 / (3.0 * slope)
        if high * high / 3.0 < apart:
            return math.nan  # softer than the patch allows
    z = math.sqrt(apart)
    for _ in range(100):
        value = z * z * (1.0 + slope * z) - apart
        if value > 0.0:
            high = z
        else:
            low = z
        derivative = z * (2.0 + 3.0 * slope * z)
        new = z - value / derivative if derivative > 0.0 else 0.5 * (low + high)
        if not low <= new <= high:
            new = 0.5 * (low + high)
        if abs(new - z) <= 1e-15 * high:
            z = new
            break
        z = new
    return hertz * z**3

"""The impact on reduced classes of symmetry: the first contact's acceleration, and how it changes with each choice."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

import modal

AFTER = 1.03  # the series end at so many times the first contact's end


@dataclass(frozen=True)
class Steps:
    """Length, s, and the frequency, Hz, above which a mode answers as a spring."""

    length: float = 5e-8
    springs: float = 1e5


def acceleration(case, classes, number, radius, steps):
    """At the times 0, step, …: m/s2, with the patch of this number and radius (m).

    Modes of high frequency answer as springs, phi^2 / omega^2, which belong to the contact law as the half-space's dent does. So the
    law is that of the whole local field, which grows for patches that are smaller than the contact, too.
    """
    scene = case.scene
    squares, shapes = (np.concatenate(part) for part in zip(*(reduced.modes(number) for reduced in classes), strict=True))
    springs = squares > (2 * math.pi * steps.springs) ** 2
    dent = scene.dent(radius) - np.sum(shapes[springs] ** 2 / squares[springs])
    count = round(scene.end / steps.length)
    forces = modal.newmark(
        squares[~springs], shapes[~springs], scene.mass, scene.hertz_stiffness, dent, scene.speed, steps.length, count
    )
    if not np.isfinite(forces).all():
        raise ArithmeticError("the contact law has no answer: the patch is too small")
    return forces / scene.mass


def first_contact(acceleration):
    """The number of steps to its end."""
    return 1 + int(np.argmax(acceleration[1:] == 0.0))


def limit(radii, accelerations):
    """To r_p -> 0 from two radii, by r_p^2."""
    large, small = (radius**2 for radius in radii)
    return (large * accelerations[1] - small * accelerations[0]) / (large - small)


def thinned(time, acceleration, end, bound):
    """Times and accelerations of equal distance up to `end`, as few (a doubled number) as a cubic spline needs; and its error."""
    keep = time <= end
    time, acceleration = time[keep], acceleration[keep]
    rows = 100
    while True:
        # Whole steps apart, so that a row is a value that was computed.
        rows_kept = np.unique(np.round(np.linspace(0, len(time) - 1, rows + 1)).astype(int))
        spline = CubicSpline(time[rows_kept], acceleration[rows_kept], bc_type="natural")
        error = np.max(np.abs(spline(time) - acceleration)) / np.max(acceleration)
        if error < bound:
            return time[rows_kept], acceleration[rows_kept], error
        rows *= 2

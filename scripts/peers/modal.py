"""Time loop in modal coordinates, compiled by numba.

A mode y of a body moves by y'' + omega^2 y = phi F, the impactor by m0 q'' = -F, F = k0 <alpha>^1.5,
alpha = q - sum phi y + c F. Average acceleration: a step is that of every mode without contact, one scalar equation for F, and
the modes' answer to F, which is exactly the Newton iteration of all unknowns, condensed (Sherman and Morrison).
"""

import numba
import numpy as np


@numba.njit(cache=True)
def force(apart, yielding, hertz):
    """F of F = k0 <apart - yielding F>^1.5: Newton's iteration in z = alpha^0.5, inside a bracket."""
    if apart <= 0.0:
        return 0.0
    # For alpha = z^2: z^2 + slope z^3 = apart, which grows with z up to -2 / (3 slope) where slope is negative.
    slope = yielding * hertz
    low, high = 0.0, np.sqrt(apart)
    if slope < 0.0:
        low, high = high, -2.0 / (3.0 * slope)
        if high * high / 3.0 < apart:
            return np.nan  # softer than the patch allows
    z = np.sqrt(apart)
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


@numba.njit(cache=True, fastmath=True)
def newmark(squares, shapes, mass, hertz, dent, speed, step, steps):
    """Forces F at the times 0, step, …, of modes with omega^2 = squares (1/s2) and phi = shapes (kg^-0.5)."""
    modes = len(squares)
    place, velocity, acceleration = np.zeros(modes), np.zeros(modes), np.zeros(modes)
    quarter = 0.25 * step * step
    answer = shapes / (1.0 + quarter * squares)  # acceleration by the force
    yielding = quarter * (shapes @ answer + 1.0 / mass) - dent
    forces = np.zeros(steps + 1)
    q, rate, old = 0.0, speed, 0.0
    for number in range(1, steps + 1):
        hit = 0.0
        for mode in range(modes):
            trial = place[mode] + step * velocity[mode] + quarter * acceleration[mode]
            new = -squares[mode] * trial / (1.0 + quarter * squares[mode])
            velocity[mode] += 0.5 * step * (acceleration[mode] + new)
            place[mode] = trial + quarter * new
            acceleration[mode] = new
            hit += shapes[mode] * place[mode]
        q += step * rate - quarter * old / mass
        f = force(q - hit, yielding, hertz)
        for mode in range(modes):
            more = answer[mode] * f
            acceleration[mode] += more
            velocity[mode] += 0.5 * step * more
            place[mode] += quarter * more
        q -= quarter * f / mass
        rate -= 0.5 * step * (old + f) / mass
        old = f
        forces[number] = f
    return forces


def history(squares, shapes, contact, end, step):
    """Times (s) and accelerations (m/s2) of the impactor."""
    steps = round(end / step)
    forces = newmark(squares, shapes, contact.mass, contact.hertz, contact.dent, contact.speed, step, steps)
    return step * np.arange(steps + 1), forces / contact.mass

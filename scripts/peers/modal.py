"""Time loop in modal coordinates, compiled by numba.

A mode y of a body moves by y'' + omega^2 y = phi F, the impactor by m0 q'' = -F, F = k0 <alpha>^1.5,
alpha = q - sum phi y + c F. Average acceleration: a step is that of every mode without contact, one scalar equation for F, and
the modes' answer to F, which is exactly the Newton iteration of all unknowns, condensed (Sherman and Morrison).
"""

import numba
import numpy as np

import contact

force = numba.njit(cache=True)(contact.force)


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


def history(squares, shapes, impactor, end, step):
    """Times (s) and accelerations (m/s2) of the impactor."""
    steps = round(end / step)
    forces = newmark(squares, shapes, impactor.mass, impactor.hertz, impactor.dent, impactor.speed, step, steps)
    return step * np.arange(steps + 1), forces / impactor.mass

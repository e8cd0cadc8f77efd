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
def newmark(squares, shapes, stresses, mass, hertz, dent, speed, step, steps):
    """Forces F (N) and tensions (Pa) at the times 0, step, …

    Of modes with omega^2 = squares (1/s2) and phi = shapes (kg^-0.5); stresses (Pa kg^-0.5 / m) has a row for each normal stress
    under the hit, and the tension is the larger one.
    """
    modes = len(squares)
    place, velocity, acceleration = np.zeros(modes), np.zeros(modes), np.zeros(modes)
    quarter = 0.25 * step * step
    answer = shapes / (1.0 + quarter * squares)  # acceleration by the force
    yielding = quarter * (shapes @ answer + 1.0 / mass) - dent
    forces, tensions = np.zeros(steps + 1), np.zeros(steps + 1)
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
        first, second = 0.0, 0.0
        for mode in range(modes):
            more = answer[mode] * f
            acceleration[mode] += more
            velocity[mode] += 0.5 * step * more
            place[mode] += quarter * more
            first += stresses[0, mode] * place[mode]
            second += stresses[1, mode] * place[mode]
        q -= quarter * f / mass
        rate -= 0.5 * step * (old + f) / mass
        old = f
        forces[number] = f
        tensions[number] = max(first, second)
    return forces, tensions


def history(basis, impactor, end, step):
    """Times (s), accelerations of the impactor (m/s2), and tensions (Pa) under the hit on the other face."""
    steps = round(end / step)
    squares, shapes, stresses = basis
    forces, tensions = newmark(squares, shapes, stresses, impactor.mass, impactor.hertz, impactor.dent, impactor.speed, step, steps)
    return step * np.arange(steps + 1), forces / impactor.mass, tensions

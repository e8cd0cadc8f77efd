"""How much stiffer a clamped edge is than Reissner's plate: the constants of src/space/plate/edges.rs.

    scripts/peers/python scripts/independent/clamped_strip.py

A strip in plane strain, of thickness 1 and clamped at x = 0, under a moment M and a shear force Q at its other end (NumPy alone:
quadrilaterals of order 5, graded towards the corners). Printed are, for each Poisson's ratio ν,

- C, by which the rotation is smaller than that of a plate, in M/D;
- S, the same of the deflection, in Q over the shear stiffness 5/6 μ.
"""

import numpy as np
from numpy.polynomial.legendre import Legendre, leggauss, legvander

ORDER, LEVELS, RATIO, LENGTH = 5, 7, 0.35, 4.0


def shapes(points):
    """Values and slopes of Lagrange's functions on [-1, 1]."""
    nodes = -np.cos(np.pi * np.arange(ORDER + 1) / ORDER)
    of_legendre = np.linalg.inv(legvander(nodes, ORDER))
    slopes = np.stack([Legendre.basis(k).deriv()(points) for k in range(ORDER + 1)], axis=1)
    return legvander(points, ORDER) @ of_legendre, slopes @ of_legendre


def strip(poisson):
    """C and S."""
    grading = [RATIO**k for k in range(LEVELS, 0, -1)]
    xs = np.array([0.0] + [0.7 * g for g in grading] + list(np.linspace(0.7, LENGTH, 6)))
    zs = np.array([0.0] + sorted(0.5 - 0.5 * g for g in grading) + [0.5])
    rows, columns = (len(ends) - 1 for ends in (xs, zs))
    across = columns * ORDER + 1
    count = (rows * ORDER + 1) * across
    mu, lame = 0.5 / (1 + poisson), poisson / ((1 + poisson) * (1 - 2 * poisson))
    law = np.array([[lame + 2 * mu, lame, 0], [lame, lame + 2 * mu, 0], [0, 0, mu]])
    points, weights = leggauss(ORDER + 2)
    values, slopes = shapes(points)
    stiffness, loads = np.zeros((2 * count, 2 * count)), np.zeros((2 * count, 2))
    local = np.arange(ORDER + 1)
    for j in range(columns):
        half_z = 0.5 * (zs[j + 1] - zs[j])
        z = zs[j] + half_z * (1 + points)
        end = rows * ORDER * across + j * ORDER + local
        loads[end, 0] += values.T @ (weights * half_z * 12 * z)
        loads[count + end, 1] += values.T @ (weights * half_z * 1.5 * (1 - 4 * z * z))
        for i in range(rows):
            half_x = 0.5 * (xs[i + 1] - xs[i])
            own = ((i * ORDER + local)[:, None] * across + j * ORDER + local).ravel()
            along = np.einsum("ai,bj->abij", slopes / half_x, values).reshape(len(points) ** 2, -1)
            up = np.einsum("ai,bj->abij", values, slopes / half_z).reshape(len(points) ** 2, -1)
            zero = np.zeros_like(up)
            strains = np.stack([np.hstack([along, zero]), np.hstack([zero, up]), np.hstack([up, along])], axis=1)
            weight = np.outer(weights, weights).ravel() * half_x * half_z
            both = np.concatenate([own, count + own])
            stiffness[np.ix_(both, both)] += np.einsum("gai,g,ab,gbj->ij", strains, weight, law, strains, optimize=True)
    held = np.zeros(2 * count, bool)
    held[:across] = held[count : count + across] = True
    # In bending, u is odd and w is even across the middle plane.
    held[:count:across] = True
    moved = np.zeros_like(loads)
    moved[~held] = np.linalg.solve(stiffness[np.ix_(~held, ~held)], loads[~held])
    rigidity, shear = 1 / (12 * (1 - poisson**2)), 5 / 6 * mu
    work = 2 * rigidity * loads.T @ moved
    less_turned = LENGTH - work[0, 0]
    raised = abs(work[1, 0]) - (LENGTH**2 / 2 - less_turned * LENGTH)
    of_plate = LENGTH**3 / 3 + LENGTH * rigidity / shear - less_turned * LENGTH**2 + 2 * raised * LENGTH
    return less_turned, (of_plate - work[1, 1]) * shear / rigidity


for poisson in (0.0, 0.1, 0.2, 0.23, 0.3, 0.37, 0.45):
    print(poisson, "C = {:.5f}, S = {:.5f}".format(*strip(poisson)))

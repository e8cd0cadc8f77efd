"""Flexural waves of infinite stacks in three-dimensional elasticity: tests/fixtures/independent/waves.csv.

    scripts/peers/python scripts/independent/waves.py tests/fixtures/independent/waves.csv

Needs SciPy. A straight-crested wave U(z) sin(xi x), W(z) cos(xi x) on Lagrange elements of degree 8, one for each layer. A row: the
case, xi in 1/m, and the lowest circular frequency in rad/s.
"""

import sys

import numpy as np
from scipy.linalg import eigh

DEGREE = 8
GLASS = (70e9, 0.23, 2500.0)
WAVENUMBERS = (5, 10, 20, 40, 80, 160)


def interlayer(shear):
    """E, nu and density for a shear modulus, with a bulk modulus of 2 GPa."""
    nu = (6e9 - 2 * shear) / (2 * (6e9 + shear))
    return 2 * shear * (1 + nu), nu, 1100.0


# Thickness, E, nu, density from the loaded face down: src/stack/flexural_wave.rs has the same ones.
CASES = {
    "equal": ((0.010, *GLASS), (0.00076, *interlayer(1e8)), (0.010, *GLASS)),
    "unequal": ((0.010, *GLASS), (0.00038, *interlayer(1e7)), (0.004, *GLASS)),
    "five": ((0.006, *GLASS), (0.00076, *interlayer(3e7)), (0.010, *GLASS), (0.00152, *interlayer(1e6)), (0.004, *GLASS)),
    "bonded": ((0.006, *GLASS), (0.008, 2.3e9, 0.38, 1200.0)),
}


def frequency(layers, xi):
    """The lowest circular frequency."""
    points, weights = np.polynomial.legendre.leggauss(DEGREE + 2)
    nodes = np.concatenate([[-1], np.polynomial.legendre.leggauss(DEGREE - 1)[0], [1]])
    of_monomials = np.linalg.inv(np.vander(nodes, increasing=True))
    powers = np.arange(DEGREE + 1)
    value = points[:, None] ** powers @ of_monomials
    slope = powers * points[:, None] ** np.maximum(powers - 1, 0) @ of_monomials
    count = len(layers) * DEGREE + 1
    stiffness, mass = np.zeros((2, 2 * count, 2 * count))
    for number, (thickness, young, nu, density) in enumerate(layers):
        lam, mu = young * nu / (1 + nu) / (1 - 2 * nu), young / 2 / (1 + nu)
        u = number * DEGREE + powers
        w, half = count + u, thickness / 2
        values = value.T * weights * half @ value
        slopes = slope.T * weights / half @ slope
        mixed = xi * (value.T * weights @ slope)
        stiffness[np.ix_(u, u)] += (lam + 2 * mu) * xi**2 * values + mu * slopes
        stiffness[np.ix_(w, w)] += (lam + 2 * mu) * slopes + mu * xi**2 * values
        stiffness[np.ix_(u, w)] += lam * mixed - mu * mixed.T
        stiffness[np.ix_(w, u)] += lam * mixed.T - mu * mixed
        mass[np.ix_(u, u)] += density * values
        mass[np.ix_(w, w)] += density * values
    # The largest 1 / omega^2 has the smallest rounding error.
    return eigh(mass, stiffness, eigvals_only=True)[-1] ** -0.5


def main():
    with open(sys.argv[1], "w", encoding="utf-8") as file:
        print("case,wavenumber,frequency", file=file)
        for name, layers in CASES.items():
            for xi in WAVENUMBERS:
                print(f"{name},{xi},{frequency(layers, xi):.9e}", file=file)


if __name__ == "__main__":
    main()

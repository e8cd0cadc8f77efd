"""Contact of a sphere with a soft layer on a stiff one: tests/fixtures/independent/indentation.csv.

    scripts/peers/python scripts/independent/indentation.py tests/fixtures/independent/indentation.csv

Needs SciPy. The pressure is a sum of seven terms (1 - r^2/a^2)^(m - 1/2), m = 0, 1, ... on a disc of the radius a, by Galerkin's
method; at the true radius the factor of the first term, which is infinite at the rim, is zero. The stack's response comes from
finite elements through the thickness. The indentation is the approach minus the deflection under a point force, (1/2 pi) integral
of (Gamma - H) xi dxi from LONGEST on. A row: the case, the indentation in m, and the force in N.
"""

import sys

import numpy as np
from scipy.optimize import brentq
from scipy.special import gamma, jv

DEGREE = 18
TERMS = 7
RADIUS = 0.05
LONGEST = 10.0
# E* of the sphere and the layer that is hit; thickness, E, nu of the layers; indentations. src/stack/indentation.rs has the same ones.
CASES = {
    "plastic": (2.5e9, ((0.006, 2.4e9, 0.23), (0.008, 70e9, 0.23)), (1e-4, 2.5e-4, 5e-4)),
    "coat": (3.8e8, ((0.002, 2.95e8, 0.475), (0.012, 70e9, 0.23)), (1e-4, 2.5e-4, 5e-4)),
}


def response(layers, xi):
    """Deflection of the loaded face under a pressure of the wavenumber xi."""
    nodes = np.cos(np.pi * np.arange(DEGREE, -1, -1) / DEGREE)
    points, weights = np.polynomial.legendre.leggauss(DEGREE + 2)
    chebyshev = np.polynomial.chebyshev
    to_nodes = np.linalg.inv(chebyshev.chebvander(nodes, DEGREE))
    value = chebyshev.chebvander(points, DEGREE) @ to_nodes
    slopes = [chebyshev.chebval(points, chebyshev.chebder(row)) if j else 0 * points for j, row in enumerate(np.eye(DEGREE + 1))]
    slope = np.stack(slopes, 1) @ to_nodes
    count = len(layers) * DEGREE + 1
    matrix = np.zeros((2 * count, 2 * count))
    for layer, (h, young, nu) in enumerate(layers):
        lame, shear = young * nu / (1 + nu) / (1 - 2 * nu), young / 2 / (1 + nu)
        u = layer * DEGREE + np.arange(DEGREE + 1)
        w = count + u
        of_values = (value.T * weights * h / 2) @ value
        of_slopes = (slope.T * weights * 2 / h) @ slope
        mixed = xi * (lame * (value.T * weights) @ slope - shear * ((value.T * weights) @ slope).T)
        matrix[np.ix_(u, u)] += (lame + 2 * shear) * xi**2 * of_values + shear * of_slopes
        matrix[np.ix_(w, w)] += (lame + 2 * shear) * of_slopes + shear * xi**2 * of_values
        matrix[np.ix_(u, w)] += mixed
        matrix[np.ix_(w, u)] += mixed.T
    force = np.zeros(2 * count)
    force[count] = 1
    return np.linalg.solve(matrix, force)[count]


def panels(ends, points):
    """Points and weights of Gauss's rule between successive ends."""
    x, weights = np.polynomial.legendre.leggauss(points)
    middle, half = (ends[1:] + ends[:-1]) / 2, (ends[1:] - ends[:-1]) / 2
    return (middle[:, None] + half[:, None] * x).ravel(), (half[:, None] * weights).ravel()


def transforms(x):
    """Transforms of the terms of the pressure, for a unit force each."""
    orders = np.arange(TERMS) + 0.5
    return np.array([2**n * gamma(n + 1) * jv(n, x) / x**n for n in orders])


def force(modulus, layers, alpha):
    """Force at an indentation."""
    _, young, nu = layers[0]
    xi, weights = panels(np.geomspace(LONGEST, 22 / layers[0][0], 80), 6)
    beyond = weights * xi / (2 * np.pi) * (np.array([response(layers, k) for k in xi]) - 2 * (1 - nu**2) / (young * xi))
    x, of_x = panels(np.linspace(1e-9, 400, 801), 10)
    terms = transforms(x)
    half_space = (terms * of_x) @ terms.T / (np.pi * modulus)

    def factors(a):
        terms = transforms(xi * a)
        matrix = half_space / a + (terms * beyond) @ terms.T - beyond.sum()
        return np.linalg.solve(matrix, alpha - a**2 / (2 * RADIUS * (np.arange(TERMS) + 1.5)))

    hertz = np.sqrt(RADIUS * alpha)
    a = brentq(lambda a: factors(a)[0], 0.5 * hertz, 3 * hertz)
    return factors(a).sum(), a


def main():
    with open(sys.argv[1], "w", encoding="utf-8") as file:
        for name, (modulus, layers, indentations) in CASES.items():
            for alpha in indentations:
                found, a = force(modulus, layers, alpha)
                print(f"{name} {alpha:.1e} m: {found:.1f} N on {a * 1e3:.2f} mm", file=sys.stderr)
                file.write(f"{name},{alpha!r},{found:.6e}\n")


main()

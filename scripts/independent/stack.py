"""Stacks of layers at one wavenumber, in 400 digits, of which short waves lose 260: tests/fixtures/independent/stacks.csv.

    scripts/peers/python scripts/independent/stack.py tests/fixtures/independent/stacks.csv

Needs mpmath. Each layer's field is a general solution of Navier's equations in cosh, sinh and z times these; all interfaces and
faces make one system of equations. A row: the case, xi H, the depth over H, then u_r, u_z (over H / E of the first layer) and
rr + tt, rr - tt, zz, rz for a unit pressure.
"""

import sys

from mpmath import cosh, lu_solve, matrix, mp, mpf, nstr, sinh

mp.dps = 400

# Thickness, E, nu from the loaded face down: tests/properties/stack.rs has the same ones.
CASES = {
    "laminate": ((0.010, 70e9, 0.23), (0.00076, 7e6, 0.45), (0.008, 70e9, 0.23)),
    "soft": ((0.010, 70e9, 0.23), (0.00076, 7e4, 0.4999), (0.008, 70e9, 0.23)),
    "five": ((0.004, 70e9, 0.23), (0.001, 1e7, 0.49), (0.02, 3e9, -0.2), (0.0005, 1e8, 0.0), (0.006, 70e9, 0.23)),
}


def field(layer, k, z):
    """Rows u_r, u_z, zz, rz for the four constants of a layer."""
    _, young, nu = layer
    shear = young / (2 * (1 + nu))
    lam = 2 * shear * nu / (1 - 2 * nu)
    c, s = cosh(k * z), sinh(k * z)
    # u = grad(phi) - (3 - 4 nu) psi e_z + z grad(psi) with harmonic phi and psi (Papkovich and Neuber), k u_r = -k (phi + z psi).
    columns = []
    for phi, slope, psi, turn in ((c, k * s, 0, 0), (s, k * c, 0, 0), (0, 0, c, k * s), (0, 0, s, k * c)):
        u = -k * (phi + z * psi)
        w = slope + z * turn - (3 - 4 * nu) * psi
        # Derivatives along z: phi'' = k^2 phi.
        du = -k * (slope + psi + z * turn)
        dw = k**2 * phi + turn + z * k**2 * psi - (3 - 4 * nu) * turn
        zz = lam * (k * u + dw) + 2 * shear * dw
        rz = shear * (du - k * w)
        rest = 2 * (lam * (k * u + dw) + shear * k * u), -2 * shear * k * u
        columns.append((u, w, zz, rz, *rest))
    return [[column[i] for column in columns] for i in range(6)]


def solve(layers, k):
    n = 4 * len(layers)
    system, load = matrix(n, n), matrix(n, 1)
    row = 0

    def put(rows, first, sign):
        for i, values in enumerate(rows):
            for j, value in enumerate(values):
                system[row + i, first + j] = sign * value

    put(field(layers[0], k, mpf(0))[2:4], 0, 1)
    load[0] = -1
    row = 2
    for i in range(len(layers) - 1):
        put(field(layers[i], k, layers[i][0])[:4], 4 * i, 1)
        put(field(layers[i + 1], k, mpf(0))[:4], 4 * i + 4, -1)
        row += 4
    put(field(layers[-1], k, layers[-1][0])[2:4], n - 4, 1)
    return lu_solve(system, load)


with open(sys.argv[1], "w", encoding="utf8") as file:
    file.write("case,x,z,u_r,u_z,sum,difference,zz,rz\n")
    for name, given in CASES.items():
        layers = [tuple(mpf(repr(value)) for value in layer) for layer in given]
        height, young = sum(layer[0] for layer in layers), layers[0][1]
        layers = [(h / height, e / young, nu) for h, e, nu in layers]
        for x in ("1e-6", "1e-3", "0.03", "0.7", "4", "40", "300"):
            k = mpf(x)
            constants = solve(layers, k)
            for z in ("0", "0.3", "0.55", "0.8", "1"):
                at, within = 0, mpf(z)
                while at + 1 < len(layers) and within > layers[at][0]:
                    within -= layers[at][0]
                    at += 1
                rows = field(layers[at], k, within)
                values = [sum(row[j] * constants[4 * at + j] for j in range(4)) for row in rows]
                file.write(",".join([name, x, z, *(nstr(values[i], 17) for i in (0, 1, 4, 5, 2, 3))]) + "\n")

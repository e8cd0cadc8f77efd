"""Stresses near a force on a thick circular plate, less those of a thin one: tests/fixtures/independent/thick-plate.csv.

    scripts/peers/python scripts/independent/thick_plate.py tests/fixtures/independent/thick-plate.csv

Axisymmetric elasticity by NGSolve alone: thickness 1, radius 30, E = 1, simply supported on the side face (u_z = 0), Hertz's
pressure of total force 1 over the radius 0.1. What is taken off is Kirchhoff's circular plate with simply supported edges under the
smooth pressure of the same force and no second or fourth moment over the radius 2 on which the program's plates carry a force, and
the shear stress that goes with it.
"""

import math
import sys

import ngsolve as ng
import numpy as np
from netgen.occ import Glue, OCCGeometry, Rectangle

CONTACT, DISC, RADIUS, POISSON, ORDER = 0.1, 2.0, 30.0, 0.23, 6
# Of p = sum of w m / (pi R^2) (1 - r^2/R^2)^(m-1): total 1, second and fourth moments 0.
PARTS = ((3, 10.0), (4, -30.0), (5, 21.0))
RADII = (0.0, 0.03, 0.13, 0.2, 0.35, 0.6, 1.0, 1.6, 2.4)
DEPTHS = (0.0, 0.05, 0.25, 0.5, 0.75, 1.0)


def mesh(cell_size):
    """Triangles, small at the contact's edge, where the pressure's slope is infinite. The depth z goes down from 0."""
    contact, near, plate = (Rectangle(*size).Face() for size in ((CONTACT, 0.1), (3, 1), (RADIUS, 1)))
    for face, size in ((contact, 0.03), (near, 0.15), (plate, 0.5)):
        face.faces.maxh = size * cell_size
    for vertex in contact.vertices:
        if abs(vertex.p[0] - CONTACT) + abs(vertex.p[1]) < 1e-9:
            vertex.maxh = 0.002 * cell_size
    shape = Glue([contact, near - contact, plate - near])
    for edge in shape.edges:
        x, z = edge.center[0], edge.center[1]
        on = {"axis": x < 1e-9, "side": x > RADIUS - 1e-9, "contact": z < 1e-9 and x < CONTACT}
        edge.name = next((name for name, is_there in on.items() if is_there), "inner")
    return ng.Mesh(OCCGeometry(shape, dim=2).GenerateMesh(grading=0.3))


def solid(cell_size):
    """The mesh and the stresses rr, tt, zz, rz."""
    cells = mesh(cell_size)
    space = ng.H1(cells, order=ORDER, dirichlet="axis") * ng.H1(cells, order=ORDER, dirichlet="side")
    (u, w), (v, q) = space.TnT()
    r = ng.x
    shear = 0.5 / (1 + POISSON)
    lam = 2 * shear * POISSON / (1 - 2 * POISSON)

    def stress(u, w):
        strains = ng.grad(u)[0], u / r, ng.grad(w)[1]
        volume = sum(strains)
        return *(lam * volume + 2 * shear * strain for strain in strains), shear * (ng.grad(u)[1] + ng.grad(w)[0])

    rr, tt, zz, rz = stress(u, w)
    work = rr * ng.grad(v)[0] + tt * v / r + zz * ng.grad(q)[1] + rz * (ng.grad(v)[1] + ng.grad(q)[0])
    stiffness = ng.BilinearForm(2 * math.pi * r * work * ng.dx(bonus_intorder=4), symmetric=True).Assemble()
    pressure = 1.5 / (math.pi * CONTACT**2) * ng.sqrt(1 - (r / CONTACT) ** 2)
    load = ng.LinearForm(2 * math.pi * r * pressure * q * ng.ds("contact", bonus_intorder=40)).Assemble()
    field = ng.GridFunction(space)
    field.vec.data = stiffness.mat.Inverse(space.FreeDofs(), "sparsecholesky") * load.vec
    print(space.ndof, "unknowns", file=sys.stderr)
    return cells, stress(*field.components)


def plate(r, z):
    """Kirchhoff's rr, tt, zz, rz."""
    inside = max(0.0, 1 - (r / DISC) ** 2)
    force = sum(w * (1 - inside**m) for m, w in PARTS)
    # The integral of force/rho from r to the plate's edge, and of force rho from 0 to r over r^2.
    steps = np.linspace(1e-9, 1.0, 200_001)
    of = sum(w * (1 - np.maximum(0, 1 - (steps * RADIUS / DISC) ** 2) ** m) for m, w in PARTS)
    potential = np.trapezoid(np.where(steps * RADIUS >= r, of / steps, 0), steps)
    moment = np.trapezoid(np.where(steps * RADIUS <= r, of * steps, 0), steps) * (RADIUS / r) ** 2 if r else 0.0
    total = (1 + POISSON) / (2 * math.pi) * potential + (1 - POISSON) / (4 * math.pi)
    apart = -(1 - POISSON) / (2 * math.pi) * moment
    of_moment = 12 * (z - 0.5)
    shear = -6 * z * (1 - z) * force / (2 * math.pi * r) if r else 0.0
    return of_moment * (total + apart) / 2, of_moment * (total - apart) / 2, 0.0, shear


def main():
    answers = []
    for cell_size in (2.0, 1.0):
        cells, stress = solid(cell_size)
        # Off the axis by a hair, where u_r / r is 0/0.
        at = [(r, z) for r in RADII for z in DEPTHS]
        answers.append(
            np.array([[s(cells(max(r, 1e-6), min(max(z, 1e-9), 1 - 1e-9))) for s in stress] for r, z in at])
        )
    coarse, fine = answers
    print("largest change by cells of half the size:", np.abs(fine - coarse).max(axis=0), file=sys.stderr)
    with open(sys.argv[1], "w", encoding="utf8") as file:
        file.write("r,z,rr,tt,zz,rz\n")
        for (r, z), values in zip(at, fine):
            rest = [value - of_plate for value, of_plate in zip(values, plate(r, z))]
            file.write(",".join([f"{r}", f"{z}", *(f"{value:.6f}" for value in rest)]) + "\n")


main()

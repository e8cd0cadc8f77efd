"""One class of symmetry of a plate on its quarter x, y > 0: K, M and the vectors a of several patches.

A force anywhere on the plate is the sum of forces that are even or odd about the planes x = 0 and y = 0, and each of these moves
the plate within its class. Every class is a problem on the quarter: with u_z even about x = 0, u_x is zero there, and with u_z odd
u_y and u_z are.
"""

from dataclasses import dataclass

import ngsolve as ng
import numpy as np
import scipy.sparse as sparse
from ngsolve.meshes import MakeStructured3DMesh
from sksparse.cholmod import cholesky

import disc
from scene import graded
from solid import blocks

ng.SetNumThreads(1)


@dataclass(frozen=True)
class Cells:
    """Bricks graded to the point that is hit, lengths as fractions of the plate's thickness."""

    order: int
    first: float  # cells at the point
    growth: float
    largest: float
    last: float  # cells at the edge
    layers: tuple  # thicknesses from the bottom, in any unit

    def lines(self, scene, point):
        """Vertices along x, y and z, m; the point is one of them."""
        thickness = scene.size[2]
        first, largest, last = (thickness * x for x in (self.first, self.largest, self.last))
        lines = []
        for length, hit in zip(scene.size, point):
            line = hit + graded(length / 2 - hit, first, self.growth, largest, last)
            if hit > 0:
                line = np.concatenate([hit - graded(hit, first, self.growth, largest, largest)[:0:-1], line])
            lines.append(line)
        across = np.concatenate([[0.0], np.cumsum(self.layers)]) / sum(self.layers) - 0.5
        return [*lines, thickness * across]


@dataclass(frozen=True)
class Quarter:
    """K, M and the columns a, one a radius: a is both the load by a whole force of one and what reads its patch's displacement.

    M is that of the whole plate, four times the quarter's, and so is K.
    """

    stiffness: sparse.csc_matrix
    mass: sparse.csc_matrix
    loads: np.ndarray

    @classmethod
    def classes(cls, case, cells, radii):
        """One of each class of symmetry that the impact excites. Radii are in m."""
        scene, lines = case.scene, cells.lines(case.scene, case.point)
        place = lambda *x: tuple(np.interp(t, np.linspace(0, 1, len(line)), line) for t, line in zip(x, lines))
        mesh = MakeStructured3DMesh(True, *(len(line) - 1 for line in lines), mapping=place)
        space = ng.H1(mesh, order=cells.order)  # of one component: the three share it
        planes = [np.array(space.GetDofs(mesh.Boundaries(name))) for name in ("back", "left")]  # x = 0, y = 0
        # Symmetric: columns are rows.
        stiffness, mass = (4 * matrix.tocsr() for matrix in blocks(space, scene))
        discs = [disc.rule(radius, case.point, mirrored(lines)) for radius in radii]
        for parity in case.parities:
            free = np.ones((space.ndof, 3), dtype=bool)
            for axis, plane in enumerate(planes):
                odd = [component for component in range(3) if (component == axis) == (parity[axis] > 0)]
                free[np.ix_(plane, odd)] = False
            free = np.flatnonzero(free)
            loads = np.zeros((space.ndof, 3, len(radii)))
            for number, (points, weights) in enumerate(discs):
                loads[:, 2, number] = pressure(space, scene.size[2], points, weights, parity)
            yield cls(stiffness[free][:, free].T, mass[free][:, free].T, loads.reshape(-1, len(radii))[free])

    def factor(self, shift):
        """Solves with K + shift M, shift in 1/s2."""
        return cholesky((self.stiffness + shift * self.mass).tocsc(), mode="supernodal")


def mirrored(lines):
    """Vertices of the whole plate along x and y."""
    return [np.unique(np.concatenate([-line, line])) for line in lines[:2]]


def pressure(space, thickness, points, weights, parity):
    """Shape functions of one component under the pressure on the top, along -z, extended with the parity to the whole plate."""
    load = np.zeros(space.ndof)
    for point, weight in zip(points, weights):
        sign = np.prod([p if x < 0 else 1 for x, p in zip(point, parity)])
        inside = space.mesh(*np.abs(point), thickness / 2 * (1 - 1e-12))
        cell = ng.ElementId(ng.VOL, inside.nr)
        load[list(space.GetDofNrs(cell))] -= sign * weight * np.array(space.GetFE(cell).CalcShape(*inside.pnt))
    return load

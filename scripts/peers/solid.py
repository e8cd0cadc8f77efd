"""A quarter of the plate in NGSolve: high-order hexahedra, its matrices taken to SciPy, CHOLMOD's factor."""

from dataclasses import dataclass

import ngsolve as ng
import numpy as np
import scipy.sparse as sparse
from ngsolve.meshes import MakeStructured3DMesh
from sksparse.cholmod import cholesky

from contact import quarter_disc


@dataclass(frozen=True)
class Solid:
    """K, M and the vector a of a quarter model: a is both the load by a force of one and what reads the displacement.

    `stresses` has two rows, which read the normal stresses along the plate (Pa) under the hit on the other face.
    """

    stiffness: sparse.csc_matrix
    mass: sparse.csc_matrix
    load: np.ndarray
    stresses: np.ndarray

    @classmethod
    def build(cls, scene, cells):
        lines = cells.lines(scene)
        place = lambda *x: tuple(np.interp(t, np.linspace(0, 1, len(line)), line) for t, line in zip(x, lines, strict=True))
        mesh = MakeStructured3DMesh(True, *(len(line) - 1 for line in lines), mapping=place)
        space = ng.H1(mesh, order=cells.order)  # of one component: the three share it
        free = np.ones((space.ndof, 3), dtype=bool)
        for component, plane in enumerate(["back", "left"]):  # x = 0 and y = 0, planes of symmetry
            free[np.array(space.GetDofs(mesh.Boundaries(plane))), component] = False
        free = np.flatnonzero(free)
        # Symmetric: columns are rows.
        stiffness, mass = (matrix.tocsr()[free][:, free].T for matrix in blocks(space, scene))
        load = np.zeros((space.ndof, 3))
        load[:, 2] = pressure(space, scene, cells.patch * scene.size[2])
        return cls(stiffness, mass, load.ravel()[free], under_the_hit(space, scene)[:, free])

    def factor(self, shift):
        """Solves with K + shift M, shift in 1/s2."""
        return cholesky((self.stiffness + shift * self.mass).tocsc(), mode="supernodal")


def blocks(space, scene):
    """K with its elastic support, and M, in blocks of 3 x 3, by scalar forms: a fourth of the time of vectorial ones."""
    lam, mu = scene.lame
    u, v = space.TnT()
    du, dv = ng.grad(u), ng.grad(v)
    form = ng.BilinearForm(scene.density * u * v * ng.dx).Assemble()
    density, columns, starts = (np.array(part) for part in form.mat.CSR())
    mass = sparse.csr_matrix((density, columns, starts))
    stiffness = np.empty((len(columns), 3, 3))
    for i in range(3):
        for j in range(3):
            form = ng.BilinearForm((lam * du[j] * dv[i] + mu * du[i] * dv[j]) * ng.dx)
            if i == j:
                form += mu * du * dv * ng.dx + scene.stiffness * u * v * ng.ds("front|right")
            stiffness[:, i, j] = form.Assemble().mat.CSR()[0]
    return sparse.bsr_matrix((stiffness, columns, starts)), sparse.kron(mass, sparse.eye(3))


def under_the_hit(space, scene):
    """sigma_x and sigma_y at the foot of the axis, by the gradient in the cell there: two rows of all unknowns."""
    lam, mu = scene.lame
    point = space.mesh(1e-9, 1e-9, -scene.size[2] / 2 * (1 - 1e-9))
    cell = ng.ElementId(ng.VOL, point.nr)
    # (NGSolve's objects refer to one another: each has a name, so that it lives.)
    rule, geometry = ng.IntegrationRule([tuple(point.pnt)], [1.0]), space.mesh.GetTrafo(cell)
    mapped = geometry(rule[0])
    slopes = np.array(space.GetFE(cell).CalcDShape(*point.pnt)) @ np.linalg.inv(np.array(mapped.jacobi))
    rows, dofs = np.zeros((2, space.ndof, 3)), list(space.GetDofNrs(cell))
    for row in range(2):
        for axis in range(3):
            rows[row, dofs, axis] = (lam + (2 * mu if row == axis else 0)) * slopes[:, axis]
    return rows.reshape(2, -1)


def pressure(space, scene, patch):
    """Hertz's pressure over the patch on the top, along -z, of total force one, on the shape functions of one component."""
    load = np.zeros(space.ndof)
    for (x, y), weight in zip(*quarter_disc(patch), strict=True):
        point = space.mesh(x, y, scene.size[2] / 2 * (1 - 1e-12))
        cell = ng.ElementId(ng.VOL, point.nr)
        load[list(space.GetDofNrs(cell))] -= weight * np.array(space.GetFE(cell).CalcShape(*point.pnt))
    return load

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

    `stresses` has two rows for each elastic layer, which read the normal stresses along the plate (Pa) under the hit on its lower face.
    Of a body with layers that relax, `stiffness` is what is left after all relaxation, and `distortion` the stiffness of these layers
    for a shear modulus of one.
    """

    stiffness: sparse.csc_matrix
    distortion: sparse.csc_matrix | None
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
        take = lambda matrix: matrix.tocsr()[free][:, free].T
        stiffness, mass, distortion = take(elastic(space, scene)), take(inertia(space, scene)), None
        if scene.chain:
            distortion = take(shear(space, scene))
            stiffness = stiffness + scene.chain.relaxed * distortion
        load = np.zeros((space.ndof, 3))
        load[:, 2] = pressure(space, quarter_disc(cells.patch * scene.size[2]), scene.size[2] / 2)
        heights = [scene.size[2] / 2 - depth for depth in np.cumsum([layer.thickness for layer in scene.layers])]
        feet = [height for height, layer in zip(heights, scene.layers, strict=True) if not layer.chain]
        stresses = np.concatenate([under_the_hit(space, scene, height) for height in feet])
        return cls(stiffness, distortion, mass, load.ravel()[free], stresses[:, free])

    def factor(self, shift, modulus=0.0):
        """Solves with K + modulus D + shift M, shift in 1/s2, modulus in Pa."""
        matrix = self.stiffness + shift * self.mass
        if self.distortion is not None:
            matrix = matrix + modulus * self.distortion
        return cholesky(matrix.tocsc(), mode="supernodal")


def by_layer(scene, values):
    """A coefficient with one of these numbers in each layer, from the top down."""
    *upper, coefficient = zip(scene.layers, values, strict=True)
    coefficient, height = coefficient[1], -scene.size[2] / 2 + scene.layers[-1].thickness
    for layer, value in reversed(upper):
        coefficient = ng.IfPos(ng.z - height, value, coefficient)
        height += layer.thickness
    return coefficient


def inertia(space, scene):
    """M."""
    u, v = space.TnT()
    form = ng.BilinearForm(by_layer(scene, [layer.density for layer in scene.layers]) * u * v * ng.dx).Assemble()
    density, columns, starts = (np.array(part) for part in form.mat.CSR())
    return sparse.kron(sparse.csr_matrix((density, columns, starts)), sparse.eye(3))


def elastic(space, scene):
    """K with its elastic support."""
    lam, mu = (by_layer(scene, values) for values in zip(*((layer.lam, layer.mu) for layer in scene.layers), strict=True))
    return stiffness(space, lam, mu, np.broadcast_to(scene.stiffness, 3))


def shear(space, scene):
    """D: the layers that relax, for a shear modulus of one, and no other."""
    is_in = by_layer(scene, [1.0 if layer.chain else 0.0 for layer in scene.layers])
    return stiffness(space, -2 / 3 * is_in, is_in, np.zeros(3))


def stiffness(space, lam, mu, support):
    """The stiffness for Lamé's numbers and a support for each component, in blocks of 3 x 3, by scalar forms: a fourth of the time of vectorial ones."""
    u, v = space.TnT()
    du, dv = ng.grad(u), ng.grad(v)
    values = [[None] * 3 for _ in range(3)]
    for i in range(3):
        for j in range(3):
            form = ng.BilinearForm((lam * du[j] * dv[i] + mu * du[i] * dv[j]) * ng.dx)
            if i == j:
                form += mu * du * dv * ng.dx + float(support[i]) * u * v * ng.ds("front|right")
            values[i][j], columns, starts = (np.array(part) for part in form.Assemble().mat.CSR())
    return sparse.bsr_matrix((np.moveaxis(np.array(values), 2, 0), columns, starts))


def under_the_hit(space, scene, height):
    """sigma_x and sigma_y on the axis just above a height, by the gradient in the cell there: two rows of all unknowns."""
    lam, mu = scene.lame
    point = space.mesh(1e-9, 1e-9, height + 1e-9 * scene.size[2])
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


def pressure(space, disc, height):
    """A pressure over a disc on the top, which is at a height, along -z, of total force one, on the shape functions of one component.

    The disc is points (m) and weights that integrate with the pressure.
    """
    load = np.zeros(space.ndof)
    for (x, y), weight in zip(*disc, strict=True):
        point = space.mesh(x, y, height * (1 - 1e-12))
        cell = ng.ElementId(ng.VOL, point.nr)
        load[list(space.GetDofNrs(cell))] -= weight * np.array(space.GetFE(cell).CalcShape(*point.pnt))
    return load

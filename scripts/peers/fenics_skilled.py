"""Peer: legacy FEniCS as one who knows it takes it: condensed steps on a quarter of the plate.

Graded quadratic hexahedra, more exact here than tetrahedra of as many unknowns; a patch; S = K + 4/dt^2 M factorised once; then a
step of average acceleration is one product with M, one solve and one scalar equation.
"""

import dolfin as df
import numpy as np
import scipy.sparse
from petsc4py import PETSc

import points
from contact import Impactor, force, quarter_disc
from scene import Cells, arguments, short

NAME = "legacy FEniCS, condensed"
SETTINGS = [  # cells, step (s)
    (Cells(2, 0.5, 1, 1, 6, 2), 1e-4),
    (Cells(2, 0.25, 0.5, 0.5, 4, 1), 5e-5),
    (Cells(2, 0.25, 0.25, 0.5, 3, 1, (2, 1)), 5e-5),
    (Cells(2, 0.25, 0.25, 0.5, 3, 1, (2, 1)), 2e-5),
    (Cells(2, 0.25, 0.125, 0.5, 2, 0.5, (2, 1)), 2e-5),
    (Cells(2, 0.25, 0.125, 0.5, 2, 0.5, (2, 1)), 1e-5),
    (Cells(2, 0.25, 0.125, 0.5, 2, 0.5, (2, 1)), 5e-6),
    (Cells(2, 0.25, 0.125, 0.25, 1.5, 0.5, (2, 1)), 1e-5),
    (Cells(2, 0.25, 0.125, 0.25, 1.5, 0.5, (3, 2, 1)), 5e-6),
]


class Plate:
    """S = K + shift M, M and the vector a of a quarter model."""

    def __init__(self, scene, cells, shift):
        self.lines = cells.lines(scene)
        mesh = quarter(self.lines)
        self.space = df.VectorFunctionSpace(mesh, "Lagrange", 2)
        self.where = self.space.tabulate_dof_coordinates()
        held = np.concatenate([self.dofs(axis, axis, 0.0) for axis in (0, 1)])  # planes of symmetry
        elastic, inertia = self.forms(scene)
        self.matrix, self.mass = df.PETScMatrix(), df.PETScMatrix()
        df.assemble(elastic, tensor=self.matrix)
        df.assemble(inertia, tensor=self.mass)
        self.matrix, self.mass = self.matrix.mat(), self.mass.mat()
        self.matrix.axpy(shift, self.mass, structure=PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
        self.matrix.zeroRowsColumns(held, 1.0)
        self.mass.zeroRowsColumns(held, 0.0)
        self.mass = without_zeros(self.mass)
        self.load = self.pressure(scene.size[2] * cells.patch)
        self.stresses = [self.under_the_hit(scene, axis) for axis in (0, 1)]

    def dofs(self, component, axis, value):
        """Those of a component on the plane where a coordinate has a value."""
        dofs = np.array(self.space.sub(component).dofmap().dofs(), dtype=np.int32)
        return dofs[np.abs(self.where[dofs, axis] - value) < 1e-9]

    def forms(self, scene):
        """Bilinear forms of K and M."""
        u, v = df.TrialFunction(self.space), df.TestFunction(self.space)
        lam, mu = map(df.Constant, scene.lame)
        strain = lambda w: df.sym(df.grad(w))
        elastic = (lam * df.div(u) * df.div(v) + 2 * mu * df.inner(strain(u), strain(v))) * df.dx
        if scene.stiffness:
            mesh = self.space.mesh()
            marks = df.MeshFunction("size_t", mesh, 2, 0)
            for axis in (0, 1):
                df.CompiledSubDomain("near(x[axis], end, 1e-9)", axis=axis, end=scene.size[axis] / 2).mark(marks, 1)
            elastic += df.Constant(scene.stiffness) * df.inner(u, v) * df.ds(1, domain=mesh, subdomain_data=marks)
        return elastic, df.Constant(scene.density) * df.inner(u, v) * df.dx

    def pressure(self, patch):
        """Hertz's pressure over the patch, along -z, of total force one, on the shape functions of the top."""
        points, weights = quarter_disc(patch)
        (nodes_x, values_x), (nodes_y, values_y) = (lagrange(line, x) for line, x in zip(self.lines, points.T, strict=False))
        values = values_x.T @ (weights[:, None] * values_y)
        top = self.dofs(2, 2, self.lines[2][-1])
        rows, columns = (
            np.abs(self.where[top, axis, None] - nodes).argmin(axis=1) for axis, nodes in enumerate((nodes_x, nodes_y))
        )
        load = self.matrix.createVecRight()
        load.setValues(top, -values[rows, columns])
        load.assemble()
        return load


    def under_the_hit(self, scene, along):
        """What reads the normal stress along an axis at the foot of the plate's axis: by the gradient in the cell there."""
        lam, mu = scene.lame
        corner = np.array([line[0] for line in self.lines])
        row = self.matrix.createVecRight()
        for axis, line in enumerate(self.lines):
            size = line[1] - line[0]
            for share, slope in zip((0, 0.5, 1), (-3, 4, -1), strict=True):
                place = corner + share * size * np.eye(3)[axis]
                dofs = self.dofs(axis, axis, place[axis])
                dof = dofs[np.abs(self.where[dofs] - place).sum(axis=1).argmin()]
                row.setValue(dof, (lam + (2 * mu if axis == along else 0)) * slope / size, addv=True)
        row.assemble()
        return row


def without_zeros(matrix):
    """The same matrix without the two thirds of entries that couple components in dolfin's pattern only."""
    starts, columns, values = matrix.getValuesCSR()
    csr = scipy.sparse.csr_matrix((values, columns, starts))
    csr.eliminate_zeros()
    return PETSc.Mat().createAIJ(csr.shape, csr=(csr.indptr, csr.indices, csr.data))


def quarter(lines):
    """Bricks with the given vertices along the axes."""
    cells = [len(line) - 1 for line in lines]
    mesh = df.BoxMesh.create([df.Point(0, 0, 0), df.Point(*cells)], cells, df.CellType.Type.hexahedron)
    numbers = np.rint(mesh.coordinates()).astype(int)
    mesh.coordinates()[:] = np.stack([line[numbers[:, axis]] for axis, line in enumerate(lines)], axis=1)
    return mesh


def lagrange(line, x):
    """Nodes of quadratic elements with the vertices `line`, and the shape functions' values at x, a row a point."""
    nodes = np.sort(np.concatenate([line, (line[1:] + line[:-1]) / 2]))
    cell = np.clip(np.searchsorted(line, x) - 1, 0, len(line) - 2)
    t = (x - line[cell]) / (line[cell + 1] - line[cell])
    values = np.zeros((len(x), len(nodes)))
    for local, value in enumerate([(1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1)]):
        values[range(len(x)), 2 * cell + local] = value
    return nodes, values


def factor(matrix):
    """CHOLMOD's factor: its solves take less than MUMPS's."""
    matrix.setOption(PETSc.Mat.Option.SPD, True)
    solver = PETSc.KSP().create()
    solver.setOperators(matrix)
    solver.setType("preonly")
    solver.getPC().setType("cholesky")
    solver.getPC().setFactorSolverType("cholmod")
    solver.setUp()
    return solver


def build(scene, cells, step):
    """All before the first step; what it returns takes the steps."""
    plate = Plate(scene, cells, 4 / step**2)
    solver = factor(plate.matrix)
    impactor = Impactor.quarter(scene, cells.patch * scene.size[2])
    return lambda: history(solver, plate, impactor, scene.end, step)


def history(solver, plate, impactor, end, step):
    """Times (s), accelerations (m/s2), and tensions (Pa) under the hit on the other face."""
    mass, load = plate.mass, plate.load
    answer, place, velocity, acceleration, trial, right = (load.duplicate() for _ in range(6))
    for vector in (place, velocity, acceleration):
        vector.set(0.0)
    solver.solve(load, answer)  # the displacement at the end of a step by a force of one there
    quarter = step**2 / 4
    yielding = load.dot(answer) + quarter / impactor.mass - impactor.dent
    q, speed, old = 0.0, impactor.speed, 0.0
    forces, tensions = [0.0], [0.0]
    for _ in range(round(end / step)):
        trial.waxpy(step, velocity, place)
        trial.axpy(quarter, acceleration)
        velocity.axpy(step / 2, acceleration)
        mass.mult(trial, right)
        right.scale(1 / quarter)
        solver.solve(right, place)  # without contact
        q += step * speed - quarter * old / impactor.mass
        new = force(q - load.dot(place), yielding, impactor.hertz)
        place.axpy(new, answer)
        q -= quarter * new / impactor.mass
        speed -= step / 2 * (old + new) / impactor.mass
        acceleration.waxpy(-1.0, trial, place)
        acceleration.scale(1 / quarter)
        velocity.axpy(step / 2, acceleration)
        old = new
        forces.append(new)
        tensions.append(max(row.dot(place) for row in plate.stresses))
    return step * np.arange(len(forces)), np.array(forces) / impactor.mass, np.array(tensions)


def main():
    scene, folder, budget = arguments(__doc__)
    df.set_log_level(df.LogLevel.WARNING)
    df.parameters["form_compiler"].update({"optimize": True, "cpp_optimize": True, "cpp_optimize_flags": "-O3 -march=native"})
    df.parameters["form_compiler"]["quadrature_degree"] = 4  # three Gauss points along each axis
    build(scene, Cells(2, 0.25, 5, 1, 5, 5), scene.end / 10)()  # compiles the forms
    settings = []
    for cells, step in SETTINGS:
        counts = "×".join(str(len(line) - 1) for line in cells.lines(scene))
        text = f"{counts} Q2 of a quarter, r_p {cells.patch:g} h, Δt {short(step)}"
        settings.append((text, lambda c=cells, s=step: points.timed(lambda: build(scene, c, s))))
    points.collect(NAME, settings, folder, budget)


if __name__ == "__main__":
    main()

"""The paper's impact analysis in legacy FEniCS (dolfin 2019.2), as a yardstick for time and memory.

J. Schmidt and T. Janda, "Simplified impact analysis in FEniCS using Hertz contact law" (the paper; its equation
numbers in brackets). As in its listing: mixed space of quadratic displacements and one real number, the impactor,
whose inertia is spread over the body; the matrix A = a a^T added entry by entry to the Jacobian; the Jacobian
derived from the residual and assembled anew, with a full LU, in every Newton iteration. Newmark's average
acceleration, unknown displacements. Signs: the impactor moves along d by q, alpha = q - gap - d.u(p), and the force
F = k0 <alpha>^1.5 pushes the body along d and the impactor back. SI units. One process.
"""

import argparse
import json
import math
import os
import resource
import time

# Before dolfin loads the BLAS: one thread, as for the other side of the comparison.
os.environ.setdefault("OMP_NUM_THREADS", "1")

import dolfin as df
import numpy as np

import msh

BETA, GAMMA = 0.25, 0.5  # average acceleration

DEFAULTS = {
    "young": 70e9, "poisson": 0.23, "density": 2500.0,
    "impactor_mass": 52.0, "impactor_radius": 0.05, "impactor_young": 210e9, "impactor_poisson": 0.3,
    "speed": 1.0, "gap": 0.0, "point": [0.0, 0.0, 0.05], "direction": [0.0, 0.0, -1.0],
    "stiffness": 0.0, "damping": 0.0,  # of the support on `surface`, (11) and (13)
    "surface": "side", "step": 2e-5, "end": 4e-4,
}  # fmt: skip


def box(size, cells):
    """Box centred on the origin, bricks cut into six tetrahedra each, as a msh.Mesh."""
    half = np.array(size) / 2
    mesh = df.BoxMesh(df.Point(*-half), df.Point(*half), *cells)
    mesh.init(2, 3)
    points = mesh.coordinates()
    surfaces = {"side": [], "top": [], "bottom": []}
    for facet in df.facets(mesh):
        if not facet.exterior():
            continue
        triangle = facet.entities(0)
        centre = points[triangle].mean(axis=0)
        normal = np.cross(points[triangle[1]] - points[triangle[0]], points[triangle[2]] - points[triangle[0]])
        if normal @ centre < 0:  # outward: the box is convex and holds the origin
            triangle = triangle[[0, 2, 1]]
        vertical = abs(centre[2]) < half[2] * (1 - 1e-9)
        surfaces["side" if vertical else "top" if centre[2] > 0 else "bottom"].append(triangle)
    cells = mesh.cells().copy()
    edges = points[cells[:, 1:]] - points[cells[:, :1]]
    negative = np.linalg.det(edges) < 0
    cells[negative, 2:] = cells[negative, :1:-1]
    return msh.Mesh(points, cells, {name: np.array(rows) for name, rows in surfaces.items()})


def dolfin_mesh(source, surface):
    """The dolfin mesh of a msh.Mesh, and its facets marked 1 on the named surface."""
    mesh = df.Mesh()
    editor = df.MeshEditor()
    editor.open(mesh, "tetrahedron", 3, 3)
    editor.init_vertices(len(source.points))
    editor.init_cells(len(source.cells))
    for number, point in enumerate(source.points):
        editor.add_vertex(number, point)
    for number, cell in enumerate(source.cells):
        editor.add_cell(number, cell)
    editor.close()
    marks = df.MeshFunction("size_t", mesh, 2, 0)
    mesh.init(2, 0)
    # As a list: Python 3.13 calls iter() twice in a comprehension, and dolfin's iterators end by the second call.
    facet_of = {tuple(sorted(facet.entities(0))): facet.index() for facet in list(df.facets(mesh))}
    for triangle in source.surfaces[surface]:
        marks[facet_of[tuple(sorted(triangle))]] = 1
    return mesh, marks


class Impact(df.NonlinearProblem):
    """Residual and Jacobian of one Newmark step for w = (u, q)."""

    def __init__(self, mesh, marks, par):
        super().__init__()
        element = df.MixedElement(
            [df.VectorElement("Lagrange", mesh.ufl_cell(), 2), df.FiniteElement("Real", mesh.ufl_cell(), 0)]
        )
        self.space = df.FunctionSpace(mesh, element)
        self.w, self.w_old, self.velocity, self.acceleration = (df.Function(self.space) for _ in range(4))
        self.gap = par["gap"]
        self.step = par["step"]
        self.contact_stiffness = contact_stiffness(par)
        self.assembly_seconds = 0.0
        self._forms(mesh, marks, par)
        self._localisation(par)
        # The impactor's real number is its coordinate q: its entry of the velocity is the speed.
        self.velocity.vector().axpy(par["speed"], self.impactor)

    def _forms(self, mesh, marks, par):
        # As Constants, so that other values need no other compiled form.
        lam = df.Constant(par["young"] * par["poisson"] / ((1 + par["poisson"]) * (1 - 2 * par["poisson"])))
        mu = df.Constant(par["young"] / (2 * (1 + par["poisson"])))
        density, support, damping = (df.Constant(par[key]) for key in ("density", "stiffness", "damping"))
        strain = lambda v: df.sym(df.grad(v))
        stress = lambda v: lam * df.tr(strain(v)) * df.Identity(3) + 2 * mu * strain(v)  # (4), (5)
        dx = df.Measure("dx", domain=mesh)
        ds = df.Measure("ds", domain=mesh, subdomain_data=marks)(1)
        volume = df.assemble(df.Constant(1.0) * dx)

        # Newmark: acceleration and velocity at the new time level, as functions of w.
        step = df.Constant(self.step)
        acceleration = (self.w - self.w_old - step * self.velocity) / (BETA * step**2)
        acceleration -= (1 / (2 * BETA) - 1) * self.acceleration
        velocity = self.velocity + step * ((1 - GAMMA) * self.acceleration + GAMMA * acceleration)
        u, _ = df.split(self.w)
        u_tt, q_tt = parts(acceleration)
        u_t, _ = parts(velocity)
        v, r = df.TestFunctions(self.space)
        self.residual = (
            df.inner(stress(u), strain(v)) * dx
            + density * df.inner(u_tt, v) * dx
            + df.Constant(par["impactor_mass"] / volume) * q_tt * r * dx
        )
        if par["stiffness"]:
            self.residual += support * df.inner(u, v) * ds  # (11)
        if par["damping"]:
            self.residual += damping * df.inner(u_t, v) * ds  # (13)
        self.jacobian = df.derivative(self.residual, self.w)
        # Compiled once and kept: the cost of the form compiler is no part of the assembly.
        self.residual, self.jacobian = df.Form(self.residual), df.Form(self.jacobian)

    def _localisation(self, par):
        """The vector a with -d on the displacement at the point and +1 on the impactor, and A = a a^T."""
        direction = np.array(par["direction"]) / np.linalg.norm(par["direction"])
        point = df.Point(*par["point"])
        self.impactor = df.Function(self.space).vector()
        df.PointSource(self.space.sub(1), point, 1.0).apply(self.impactor)
        self.localisation = self.impactor.copy()
        # Each source is applied once: dolfin collects the sources of all processes, so that a call on each of n
        # processes, as in the listing, multiplies a by n.
        for component, value in enumerate(direction):
            if value:
                df.PointSource(self.space.sub(0).sub(component), point, -value).apply(self.localisation)
        # Stored with the Jacobian's pattern, so that adding it to the Jacobian changes no structure and the
        # symbolic part of the LU is made once. The printed 2x2 block of +-1 holds where p is a vertex;
        # the product of all entries of a holds anywhere.
        self.contact = df.PETScMatrix()
        assemble(self.jacobian, self.contact)
        self.contact.zero()
        values = self.localisation.get_local()
        entries = np.flatnonzero(values)
        for row in entries:
            for column in entries:
                self.contact.mat().setValue(row, column, values[row] * values[column])
        self.contact.apply("insert")

    def indentation(self):
        """alpha = q - gap - d.u(p), m."""
        return self.localisation.inner(self.w.vector()) - self.gap

    def force(self):
        """Hertz's F = k0 <alpha>^1.5, N: (8)."""
        return self.contact_stiffness * max(self.indentation(), 0.0) ** 1.5

    def F(self, b, x):
        """Residual b at x, which is the vector of self.w."""
        start = time.perf_counter()
        assemble(self.residual, b)
        b.axpy(self.force(), self.localisation)
        self.assembly_seconds += time.perf_counter() - start

    def J(self, A, x):
        """Jacobian A at x; from derivative(F, w), assembled in every iteration as in the listing."""
        start = time.perf_counter()
        assemble(self.jacobian, A)
        tangent = 1.5 * self.contact_stiffness * math.sqrt(max(self.indentation(), 0.0))
        A.axpy(tangent, self.contact, True)
        self.assembly_seconds += time.perf_counter() - start

    def advance(self):
        """Velocity and acceleration at the end of a step, which then is the old state."""
        step = self.step
        new = self.w.vector().copy()  # becomes the new acceleration
        new.axpy(-1.0, self.w_old.vector())
        new.axpy(-step, self.velocity.vector())
        new *= 1 / (BETA * step**2)
        new.axpy(-(1 / (2 * BETA) - 1), self.acceleration.vector())
        self.velocity.vector().axpy(step * (1 - GAMMA), self.acceleration.vector())
        self.velocity.vector().axpy(step * GAMMA, new)
        self.acceleration.vector()[:] = new
        self.w_old.assign(self.w)


def assemble(form, tensor):
    """Assembles a compiled form as dolfin.assemble does, whose newer versions fail on compiled forms."""
    df.cpp.fem.Assembler().assemble(tensor, form)


def parts(w):
    """Displacement and impactor parts of an expression in the mixed space."""
    return df.as_vector([w[0], w[1], w[2]]), w[3]


def contact_stiffness(par):
    """k0 of (15), N/m^1.5."""
    plate = (1 - par["poisson"] ** 2) / par["young"]
    impactor = (1 - par["impactor_poisson"] ** 2) / par["impactor_young"]
    return 4 / 3 * math.sqrt(par["impactor_radius"]) / (plate + impactor)


def run(source, par):
    """Series, one row a step (t, q, u_hit, F, F/m0), and what the run cost."""
    # Compile the forms where dolfin's cache lacks them, on a mesh of one brick: no part of the times below.
    brick = dolfin_mesh(box([1, 1, 1], [1, 1, 1]), "side")
    Impact(*brick, dict(par, point=[0, 0, 0.5]))

    mesh, marks = dolfin_mesh(source, par["surface"])
    start = time.perf_counter()
    problem = Impact(mesh, marks, par)
    setup = time.perf_counter() - start

    solver = df.NewtonSolver()
    solver.parameters["linear_solver"] = "mumps"
    solver.parameters["relative_tolerance"] = 1e-14  # the absolute one decides
    # Force scale: peak of Hertz's impact on a rigid half-space. 1e-9 of it stands above the rounding of the
    # residual, and moves F by some 1e-9 of its peak (docs/comparison.md).
    solver.parameters["absolute_tolerance"] = (
        1e-9 * 1.14326 * problem.contact_stiffness**0.4 * par["impactor_mass"] ** 0.6 * par["speed"] ** 1.2
    )
    solver.parameters["report"] = False

    series = [[0.0, 0.0, 0.0, 0.0, 0.0]]
    iterations = 0
    steps = round(par["end"] / par["step"])
    start = time.perf_counter()
    for number in range(1, steps + 1):
        iterations += solver.solve(problem, problem.w.vector())[0]
        problem.advance()
        q = problem.impactor.inner(problem.w.vector())
        force = problem.force()
        u_hit = q - problem.indentation() - par["gap"]
        series.append([number * par["step"], q, u_hit, force, force / par["impactor_mass"]])
    stepping = time.perf_counter() - start
    cost = {
        "unknowns": problem.space.dim(),
        "steps": steps,
        "newton_iterations": iterations,
        "wall_time_setup": setup,
        "wall_time_steps": stepping,
        "wall_time_total": setup + stepping,
        "wall_time_assembly": problem.assembly_seconds,
        "assembly_per_iteration": problem.assembly_seconds / iterations,
        "solve_per_iteration": (stepping - problem.assembly_seconds) / iterations,
        "time_per_iteration": stepping / iterations,
        "peak_memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024,
    }
    return series, cost


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--mesh", help="MSH 4.1 ASCII file of tetrahedra")
    parser.add_argument("--size", help="LX,LY,LZ of a box, m")
    parser.add_argument("--cells", help="NX,NY,NZ bricks of the box")
    parser.add_argument("--export", help="write the box to this file and stop")
    parser.add_argument("--parameters", help="JSON file; keys: " + ", ".join(DEFAULTS))
    parser.add_argument("--series", help="CSV file for t,q,u_hit,F,acc")
    parser.add_argument("--cost", help="JSON file for times (s), iterations and memory (bytes)")
    args = parser.parse_args()
    if bool(args.mesh) == bool(args.size and args.cells):
        parser.error("give either --mesh or both --size and --cells")
    return parser, args


def main():
    parser, args = arguments()
    if df.MPI.size(df.MPI.comm_world) > 1:
        parser.error("this script runs on one process")
    df.set_log_level(df.LogLevel.WARNING)
    df.parameters["form_compiler"]["optimize"] = True
    df.parameters["form_compiler"]["cpp_optimize"] = True
    df.parameters["form_compiler"]["cpp_optimize_flags"] = "-O3 -march=native"

    if args.mesh:
        source = msh.read(args.mesh)
    else:
        source = box([float(x) for x in args.size.split(",")], [int(n) for n in args.cells.split(",")])
    if args.export:
        msh.write(args.export, source, "plate")
        return
    par = dict(DEFAULTS)
    if args.parameters:
        with open(args.parameters, encoding="utf-8") as file:
            given = json.load(file)
        unknown = sorted(set(given) - set(DEFAULTS))
        if unknown:
            parser.error(f"unknown parameters: {', '.join(unknown)}")
        par.update(given)
    if par["surface"] not in source.surfaces:
        parser.error(f"the mesh has no surface {par['surface']!r}, only {sorted(source.surfaces)}")

    series, cost = run(source, par)
    if args.series:
        np.savetxt(args.series, series, fmt="%.16e", delimiter=",", header="t,q,u_hit,F,acc", comments="")
    if args.cost:
        with open(args.cost, "w", encoding="utf-8") as file:
            json.dump(cost, file, indent=1)
    print(json.dumps(cost, indent=1))


if __name__ == "__main__":
    main()

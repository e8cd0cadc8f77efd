"""Peer: NGSolve on a large body, a step by conjugate gradients; prints a table of comma-separated values.

A quarter of the paper's 0.1 m plate in quadratic hexahedra, elastic support on its sides, Newmark's average acceleration: as scripts/scaling.
The system of a step is solved from the increment at constant acceleration on, down to a part of the right-hand side in the
preconditioner's norm.
"""

import argparse
import time

import ngsolve as ng
from ngsolve.krylovspace import CGSolver
from ngsolve.meshes import MakeStructured3DMesh

SIZE, STIFFNESS = (1.5, 1.5, 0.1), 1e9
YOUNG, POISSON, DENSITY = 70e9, 0.23, 2500.0
PATCH = 0.25  # of the thickness
MASS, HERTZ, SPEED = 52.0, 1.669e10, 1.0
TOLERANCE = 1e-6  # 1e-4 of 1e-2


def system(cells, step):
    """The space, S and M as forms, and the load by a force of one."""
    place = lambda x, y, z: (SIZE[0] / 2 * x, SIZE[1] / 2 * y, SIZE[2] * (z - 0.5))
    mesh = MakeStructured3DMesh(True, cells[0] // 2, cells[1] // 2, cells[2], mapping=place)
    space = ng.VectorH1(mesh, order=2, dirichletx="back", dirichlety="left")
    u, v = space.TnT()
    lam, mu = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON)), YOUNG / (2 * (1 + POISSON))
    strain = lambda w: ng.Sym(ng.Grad(w))
    elastic = (lam * ng.div(u) * ng.div(v) + 2 * mu * ng.InnerProduct(strain(u), strain(v))) * ng.dx
    inertia = DENSITY * ng.InnerProduct(u, v)
    form = ng.BilinearForm(space, symmetric=True)
    form += elastic + 4 / step**2 * inertia * ng.dx + STIFFNESS * u * v * ng.ds("front|right")
    mass = ng.BilinearForm(inertia * ng.dx, symmetric=True)
    patch = PATCH * SIZE[2]
    inside = 1 - (ng.x**2 + ng.y**2) / patch**2
    load = ng.LinearForm(space)
    load += -1.5 / (ng.pi * patch**2) * ng.sqrt(ng.IfPos(inside, inside, 0)) * v[2] * ng.ds("top", bonus_intorder=8)
    return space, form, mass, load


def run(cells, step, steps, name):
    """Unknowns, seconds before the first step, seconds a step, iterations of each step, and the force on the quarter at the end, N."""
    begin = time.perf_counter()
    space, form, mass, load = system(cells, step)
    preconditioner = ng.Preconditioner(form, name)
    for each in (form, mass, load):
        each.Assemble()
    vector = form.mat.CreateColVector
    answer, place, speed, acceleration, known, new = (vector() for _ in range(6))
    for each in (place, speed, acceleration):
        each[:] = 0.0
    solver = CGSolver(mat=form.mat, pre=preconditioner.mat, tol=TOLERANCE, maxiter=1000)
    answer[:] = 0.0
    solver.Solve(rhs=load.vec, sol=answer, initialize=False)
    compliance = ng.InnerProduct(load.vec, answer) + step**2 / (4 * MASS / 4)
    ready = time.perf_counter()
    q, rate, old, iterations = 0.0, SPEED, 0.0, []
    for _ in range(steps):
        known.data = 4 / step**2 * place + 4 / step * speed + acceleration
        right = vector()
        right.data = mass.mat * known
        # The increment at constant acceleration, less what the force of the step before gives.
        new.data = place + step * speed + step**2 / 2 * acceleration - old * answer
        solver.Solve(rhs=right, sol=new, initialize=False)
        iterations.append(solver.iterations)
        free = q + step * rate - step**2 / 4 * old / (MASS / 4)
        force = contact(free - ng.InnerProduct(load.vec, new), compliance)
        new.data += force * answer
        known.data = 4 / step**2 * (new - place) - 4 / step * speed - acceleration
        speed.data += step / 2 * (acceleration + known)
        place.data, acceleration.data = new, known
        q = free - step**2 / 4 * force / (MASS / 4)
        rate -= step / 2 * (old + force) / (MASS / 4)
        old = force
    seconds = (time.perf_counter() - ready) / steps
    return sum(space.FreeDofs()), ready - begin, seconds, iterations, old


def contact(apart, compliance):
    """F of a quarter: F = k0/4 <apart - s F>^1.5, by bisection."""
    low, high = 0.0, max(apart, 0.0)
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if middle + compliance * HERTZ / 4 * middle**1.5 < apart else (low, middle)
    return HERTZ / 4 * low**1.5


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cells", default="80,80,8", help="of the whole plate")
    parser.add_argument("--step", type=float, default=2e-5, help="s")
    parser.add_argument("--steps", type=int, default=10)
    parser.add_argument("--threads", default="1,2")
    parser.add_argument("--preconditioners", default="local,bddc")
    args = parser.parse_args()
    print("preconditioner,threads,unknowns,before,step,least,most,force", flush=True)
    cells = tuple(int(number) for number in args.cells.split(","))
    for threads in (int(number) for number in args.threads.split(",")):
        ng.SetNumThreads(threads)
        for name in args.preconditioners.split(","):
            with ng.TaskManager():
                unknowns, before, seconds, iterations, force = run(cells, args.step, args.steps, name)
            counts = f"{min(iterations[1:])},{max(iterations[1:])}"
            print(f"{name},{threads},{unknowns},{before:.4g},{seconds:.4g},{counts},{4 * force:.6g}", flush=True)


if __name__ == "__main__":
    main()

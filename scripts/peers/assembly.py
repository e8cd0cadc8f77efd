"""Seconds that legacy FEniCS takes to assemble K and M of quadratic hexahedra, on one core.

Prints a line a mesh: cells, unknowns, and for each matrix the first assembly, which makes the pattern, and one into the matrix
that is there. Compiled forms do not count: a mesh of one cell comes first.
"""

import time

import dolfin as df

MESHES = ((20, 20, 2), (30, 30, 3))
SIZE = (1.5, 1.5, 0.1)  # m
YOUNG, POISSON, DENSITY = 70e9, 0.23, 2500.0
REPEATS = 3


def forms(cells):
    """The space, and K and M."""
    corners = [df.Point(*(sign * x / 2 for x in SIZE)) for sign in (-1, 1)]
    mesh = df.BoxMesh.create(corners, cells, df.CellType.Type.hexahedron)
    space = df.VectorFunctionSpace(mesh, "Lagrange", 2)
    u, v = df.TrialFunction(space), df.TestFunction(space)
    lam = df.Constant(YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON)))
    mu = df.Constant(YOUNG / (2 * (1 + POISSON)))
    strain = lambda w: df.sym(df.grad(w))
    stiffness = (lam * df.div(u) * df.div(v) + 2 * mu * df.inner(strain(u), strain(v))) * df.dx
    return space, {"K": df.Form(stiffness), "M": df.Form(df.Constant(DENSITY) * df.inner(u, v) * df.dx)}


def seconds(work):
    """How long `work` takes."""
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def main():
    df.set_log_level(df.LogLevel.WARNING)
    df.parameters["form_compiler"].update({"optimize": True, "cpp_optimize": True, "cpp_optimize_flags": "-O3 -march=native"})
    df.parameters["form_compiler"]["quadrature_degree"] = 4  # three Gauss points along each axis
    for form in forms((1, 1, 1))[1].values():
        df.assemble(form)
    for cells in MESHES:
        space, integrals = forms(cells)
        for name, form in integrals.items():
            matrix = df.PETScMatrix()
            first = seconds(lambda: df.assemble(form, tensor=matrix))
            again = min(seconds(lambda: df.assemble(form, tensor=matrix)) for _ in range(REPEATS))
            print(f"{'×'.join(map(str, cells))} Q2, {space.dim()} unknowns, {name}: first {first:.3f} s, again {again:.3f} s", flush=True)


if __name__ == "__main__":
    main()

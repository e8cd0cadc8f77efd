"""Peer: NGSolve's matrices of a free body on a mesh by Gmsh, on load-dependent Ritz vectors, as python_ritz has them on boxes."""

import argparse
import tomllib
from pathlib import Path

import ngsolve as ng
import numpy as np
from netgen.read_gmsh import ReadGmsh

import modal
import points
from contact import Impactor, whole_disc
from python_ritz import ritz_modes
from scene import Scene, short
from solid import Solid, elastic, inertia, pressure, under_the_hit

NAME = "NGSolve + Ritz vectors"
SETTINGS = [(30, 4e-6), (45, 2e-6), (70, 2e-6), (110, 1e-6)]  # vectors, step (s)
REFERENCE = (200, 5e-7)


def read(path):
    """The scene of a ricochet's file, the order of its elements, and the patch (m). The hit is on the axis of z, in the middle of the top."""
    given = tomllib.loads(path.read_text(encoding="utf-8"))
    body, impactor = given["body"], given["impactor"]
    x, y, top = impactor["point"]
    if (x, y) != (0.0, 0.0) or "support" in given:
        raise SystemExit(f"{path}: a free body that is hit on the axis of z is needed")
    scene = Scene(
        (0.0, 0.0, 2 * top), 0.0, given["time"]["end"], body["young"], body["poisson"], body["density"], impactor["mass"],
        impactor["radius"], impactor["young"], impactor["poisson"], impactor["speed"],
    )  # fmt: skip
    return scene, body["order"], given["contact"]["patch_radius"]


def whole(scene, path, order, patch):
    """All unknowns of the body on a mesh of format 2.2."""
    space = ng.H1(ng.Mesh(ReadGmsh(str(path))), order=order)  # of one component: the three share it
    load = np.zeros((space.ndof, 3))
    load[:, 2] = pressure(space, whole_disc(patch), scene.size[2] / 2)
    stiffness, mass = (matrix.tocsc() for matrix in (elastic(space, scene), inertia(space, scene)))
    return Solid(stiffness, None, mass, load.ravel(), under_the_hit(space, scene, -scene.size[2] / 2))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, metavar="OUTDIR")
    parser.add_argument("scene", type=Path)
    parser.add_argument("mesh", type=Path)
    arguments = parser.parse_args()
    scene, order, patch = read(arguments.scene)
    ng.SetNumThreads(1)

    def build(count, step):
        basis = ritz_modes(whole(scene, arguments.mesh, order, patch), count)
        return lambda: modal.history(basis, Impactor.whole(scene, patch), scene.end, step)

    # Of one mode, for compiling.
    modal.history((np.ones(1), np.ones(1), np.ones((2, 1))), Impactor.whole(scene, patch), scene.end, scene.end / 10)
    settings = [
        (f"{count} vectors, Δt {short(step)}", lambda count=count, step=step: points.timed(lambda: build(count, step)))
        for count, step in [*SETTINGS, REFERENCE]
    ]
    points.collect(NAME, settings, arguments.folder, float("inf"))


if __name__ == "__main__":
    main()

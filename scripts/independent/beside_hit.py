"""Stresses on the lower face beside the hit, through the first contact: tests/fixtures/independent/beside-CASE.csv.

    PYTHONPATH=scripts/peers:scripts $(scripts/peers/python) scripts/independent/beside_hit.py tests/fixtures/independent plate100-k0

beside_hit.py OUTDIR CASE writes OUTDIR/beside-CASE.csv. Columns: time (s), force (N), then sigma_rr and sigma_tt (Pa) at RADII thicknesses from the line of the force,
along x. The force is Hertz's pressure over h/4, whatever the contact's own radius is. The plate is the quarter of hexahedra of
fixture.py, on load-dependent Ritz vectors, whose stresses are read on the lower face. Its own error, printed, is what hexahedra of one
order less and half of the vectors change, over the peak of each history.
"""

import math
import sys
from dataclasses import replace
from pathlib import Path

import ngsolve as ng
import numpy as np
import scipy.linalg as dense
from scipy.interpolate import CubicSpline
from scipy.signal import lfilter

import modal
from cases import CASES
from fixture import CELLS
from impact import AFTER, Steps, first_contact
from quarter import Quarter
from reduced import Reduced

RADII = (0.0, 0.25, 0.5, 1.0, 2.0)
PATCH = 0.25
VECTORS = 160
ROWS = 60  # doubled until a cubic spline between them is as good as this, of each peak:
BETWEEN = 2e-3


class Reader:
    """Reads sigma_rr and sigma_tt on the lower face along x, of displacements at the free unknowns of the quarter."""

    def __init__(self, case, quarter, space, free):
        self.case, self.space, self.free, self.count = case, space, free, quarter.mass.shape[0]

    def stresses(self, vectors):
        """A row for rr and one for tt of each point, by the columns."""
        scene = self.case.scene
        lam, mu = scene.lame
        low = -0.5 * scene.size[2] * (1 - 1e-9)
        field = ng.GridFunction(self.space)
        # In the plane, off the planes of symmetry by a hair.
        hair = 1e-9 * scene.size[2]
        points = [self.space.mesh(max(r * scene.size[2], hair), hair, low) for r in RADII]
        rows = np.empty((2 * len(RADII), vectors.shape[1]))
        for number, vector in enumerate(vectors.T):
            full = np.zeros(3 * self.space.ndof)
            full[self.free] = vector
            strains = np.zeros((3, len(RADII)))
            for axis in range(3):
                field.vec.FV().NumPy()[:] = full[axis::3]
                strains[axis] = [ng.grad(field)(point)[axis] for point in points]
            volume = strains.sum(axis=0)
            rows[:, number] = np.stack([lam * volume + 2 * mu * strains[axis] for axis in (0, 1)], axis=1).ravel()
        return rows


def reader(case, cells, quarter):
    """The space and the free unknowns are those of Quarter.classes, of the even class."""
    lines = cells.lines(case.scene, case.point)
    place = lambda *x: tuple(np.interp(t, np.linspace(0, 1, len(line)), line) for t, line in zip(x, lines))
    mesh = ng.meshes.MakeStructured3DMesh(True, *(len(line) - 1 for line in lines), mapping=place)
    space = ng.H1(mesh, order=cells.order)
    free = np.ones((space.ndof, 3), dtype=bool)
    for axis, name in enumerate(("back", "left")):
        free[np.array(space.GetDofs(mesh.Boundaries(name))), axis] = False
    return Reader(case, quarter, space, np.flatnonzero(free))


def basis(quarter, count):
    """M-orthonormal Ritz vectors of the load."""
    factor = quarter.factor((2 * math.pi * 1000.0) ** 2)
    vectors = np.empty((len(quarter.loads), count), order="F")
    right = quarter.loads[:, 0]
    for number in range(count):
        vector, earlier = factor(right), vectors[:, :number]
        weighted = quarter.mass @ vector
        for _ in range(2):
            vector -= earlier @ (earlier.T @ weighted)
            weighted = quarter.mass @ vector
        norm = math.sqrt(vector @ weighted)
        vectors[:, number] = vector / norm
        right = weighted / norm
    return vectors


def histories(case, order, steps, counts):
    """For each number of vectors the force and the stresses, step by step."""
    scene, cells = case.scene, replace(CELLS, order=order)
    radius = PATCH * scene.size[2]
    (quarter,) = Quarter.classes(case, cells, [radius])
    vectors = basis(quarter, max(counts))
    print(case, order, vectors.shape, flush=True)
    read = reader(case, cells, quarter).stresses(vectors)
    stiffness, load = vectors.T @ (quarter.stiffness @ vectors), vectors.T @ quarter.loads[:, 0]
    found = []
    for count in counts:
        squares, turned = dense.eigh(stiffness[:count, :count])
        shapes, of_stress = turned.T @ load[:count], read[:, :count] @ turned
        springs = squares > (2 * math.pi * steps.springs) ** 2
        dent = scene.dent(radius) - np.sum(shapes[springs] ** 2 / squares[springs])
        number = round(scene.end / steps.length)
        forces = modal.newmark(squares[~springs], shapes[~springs], scene.mass, scene.hertz_stiffness, dent,
                               scene.speed, steps.length, number)  # fmt: skip
        stress = np.outer(of_stress[:, springs] @ (shapes[springs] / squares[springs]), forces)
        for square, shape, reading in zip(squares[~springs], shapes[~springs], of_stress[:, ~springs].T):
            # Average acceleration, as a recurrence of y in F.
            quarter_step = 0.25 * steps.length**2
            of_force = quarter_step * shape * np.array([1.0, 2.0, 1.0])
            of_place = [1 + quarter_step * square, 2 * quarter_step * square - 2, 1 + quarter_step * square]
            stress += np.outer(reading, lfilter(of_force, of_place, forces))
        found.append((forces, stress))
    return found


def main(folder, name):
    case, steps = CASES[name], Steps()
    (half, whole) = histories(case, CELLS.order, steps, (VECTORS // 2, VECTORS))
    ((_, coarse),) = histories(case, CELLS.order - 1, steps, (VECTORS,))
    forces, stress = whole
    last = first_contact(forces)
    end = min(len(forces), round(AFTER * last))
    peaks = np.abs(stress[:, :last]).max(axis=1)
    change = lambda other: np.abs(other - stress)[:, :last].max(axis=1) / peaks
    count, between = ROWS // 2, np.array([np.inf])
    while between.max() > BETWEEN:
        count *= 2
        rows = np.unique(np.round(np.linspace(0, end - 1, count + 1)).astype(int))
        spline = CubicSpline(rows, stress[:, rows].T, bc_type="natural")(np.arange(end)).T
        between = np.abs(spline - stress[:, :end]).max(axis=1) / peaks
    with np.printoptions(formatter={"float": "{:.3g}".format}):
        print(name, "peaks, MPa", peaks * 1e-6, "order", change(coarse), "vectors", change(half[1]), "rows", between, sep="\n")
    header = ["time", "force", *(f"{component}{radius:g}" for radius in RADII for component in ("rr", "tt"))]
    table = np.column_stack([steps.length * rows, forces[rows], stress[:, rows].T])
    np.savetxt(folder / f"beside-{name}.csv", table, fmt=["%.7e", *["%.5e"] * (table.shape[1] - 1)],
               delimiter=",", header=",".join(header), comments="")  # fmt: skip


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2])

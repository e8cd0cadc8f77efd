"""Peer: the paper's listing in legacy FEniCS. Whole plate, quadratic tetrahedra, point load, full Newton with an LU in each."""

import sys
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).parent.parent))

import dolfin as df

import fenics_listing
import points
from scene import arguments, short

NAME = "legacy FEniCS, the paper's listing"
SETTINGS = [  # cells, step (s)
    ((6, 6, 1), 1e-4),
    ((6, 6, 1), 5e-5),
    ((10, 10, 1), 1e-4),
    ((10, 10, 1), 5e-5),
    ((14, 14, 1), 1e-4),
    ((14, 14, 1), 5e-5),
]


def measure(scene, cells, step):
    """Seconds of set-up and steps, and the series. Neither the mesh nor compiled forms count: the listing's own times."""
    parameters = dict(
        fenics_listing.DEFAULTS, stiffness=scene.stiffness, point=[0, 0, scene.size[2] / 2], step=step, end=scene.end
    )
    series, cost = fenics_listing.run(fenics_listing.box(scene.size, cells), parameters)
    return cost["wall_time_setup"], cost["wall_time_steps"], np.array(series)[:, [0, 4]]


def main():
    scene, folder, budget = arguments(__doc__)
    df.set_log_level(df.LogLevel.WARNING)
    df.parameters["form_compiler"]["optimize"] = True
    df.parameters["form_compiler"]["cpp_optimize"] = True
    df.parameters["form_compiler"]["cpp_optimize_flags"] = "-O3 -march=native"
    settings = [
        (f"{'×'.join(map(str, cells))} P2, Δt {short(step)}", lambda c=cells, s=step: measure(scene, c, s))
        for cells, step in SETTINGS
    ]
    points.collect(NAME, settings, folder, budget)


if __name__ == "__main__":
    main()

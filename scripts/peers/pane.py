"""Peer: a window pane of 1.0 × 1.5 × 0.008 m, on springs along its sides, hit in its middle by a heavy ball, as python_ritz has plates."""

import argparse
import math
from pathlib import Path

import bases
from python_ritz import NAME, ritz_modes
from scene import Cells, Scene

SCENE = Scene((1.0, 1.5, 0.008), (0.0, 0.0, 5e8), end=0.02, mass=4.11, radius=0.05, speed=7.672)
SETTINGS = [  # cells, vectors, step (s)
    (Cells(4, 0.25, 0.5, 1, 8, 3), 100, 1e-5),
    (Cells(4, 0.25, 0.5, 1, 8, 3), 200, 5e-6),
    (Cells(4, 0.25, 0.5, 1, 6, 2), 300, 5e-6),
    (Cells(4, 0.25, 0.5, 1, 6, 2), 450, 2e-6),
    (Cells(4, 0.25, 0.5, 1, 4, 1), 600, 2e-6),
]


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, metavar="OUTDIR")
    bases.collect(SCENE, parser.parse_args().folder, math.inf, NAME, ritz_modes, "vectors", SETTINGS)

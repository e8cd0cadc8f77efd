"""panes.py PROGRAM OUT DOCUMENT: estimated against true errors of thin panes; see scripts/panes."""

import subprocess
import sys
from pathlib import Path

import numpy as np

from estimate_scenes import Draw, Scene, halton
from estimates import Result, percent
from markers import replace, table

TOLERANCE = 1e-2
REFERENCE = 1.4e-3
# Panes 1 to 12 are among the 31 on which the estimates were calibrated.
NUMBERS = range(13, 25)
HEAD = ["pane", "impactor", "first contact", "vectors", "acceleration: error (estimate)", "tension near its peak", "time", "time of the reference"]
EDGES = ("free", 1e8, 1e10, "held", "clamped")


def drawn(number):
    """A pane by Halton's sequence: 80 to 200 thicknesses, hit by a small fast ball; one in three off its middle."""
    draw = Draw(number)
    edge = draw.between(3, 0.4, 1.2)
    thickness = float(f"{edge / (80 * (200 / 80) ** halton(number, 2)):.2g}")
    size = (edge, float(f"{edge * draw.one_of(17, (1.0, 1.4, 0.7)):.2g}"), thickness)
    point = tuple(float(f"{part * side:.2g}") for part, side in zip(draw.one_of(19, ((0.0, 0.0), (0.0, 0.0), (0.2, 0.1))), size))
    weight = 2500 * size[0] * size[1] * thickness
    # A ball of steel of a mass between 0.5% and 20% of the pane's.
    mass = float(f"{weight * 0.005 * 40 ** halton(number, 5):.2g}")
    radius = float(f"{(3 * mass / (4 * np.pi * 7800)) ** (1 / 3):.2g}")
    return Scene(size, draw.one_of(13, EDGES), mass, radius, draw.between(11, 1, 6), point, "glass")


def run(program, folder, scene, model, end, tolerance, more=()):
    """A result, with more keys of the scene."""
    source, result = folder / "scene.toml", folder / f"{'-'.join([str(tolerance), *more])}.h5"
    source.write_text(scene.text(end))
    keys = (f"body.model={model}", f"accuracy.tolerance={tolerance}", *more)
    overrides = [word for key in keys for word in ("--set", key)]
    subprocess.run([program, "-q", "run", source, "-o", result, "--force", *overrides], check=True, capture_output=True)
    return Result(result, scene.tension_face)


def seconds(result):
    """Wall time with two digits, or without decimals from 100 s."""
    return f"{result.seconds:.2g}" if result.seconds < 99.5 else f"{result.seconds:.0f}"


def row(program, out, number, scene, model, reference_tolerance):
    """One pane in a theory: errors against a run at another tolerance, estimates and times."""
    folder, end = out / str(number), 5e-4
    folder.mkdir(parents=True, exist_ok=True)
    while not np.isfinite(first := run(program, folder, scene, model, end, TOLERANCE).first_end):
        end *= 2
    end = float(f"{0.99 * first:.4e}")
    own, reference = (run(program, folder, scene, model, end, tolerance) for tolerance in (TOLERANCE, reference_tolerance))
    errors = own.errors(reference)
    pairs = [(errors[quantity], own.estimates[quantity]) for quantity in ("acceleration", "tension")]
    ratio = [estimate / error for error, estimate in pairs]
    cells = [f"{percent(error)} ({percent(estimate)})" for error, estimate in pairs]
    words = [scene.plate(), scene.impactor(), f"{1e3 * first:.2g} ms", own.reduction.split()[0], *cells, f"{seconds(own)} s", f"{seconds(reference)} s"]
    print(number, *words, *(f"{of:.1f}" for of in ratio), flush=True)
    return words


def main():
    program, out, document = sys.argv[1], Path(sys.argv[2]), sys.argv[3]
    rows = [row(program, out, number, drawn(number), "mindlin", REFERENCE) for number in NUMBERS]
    replace(document, "panes", table(HEAD, rows))


if __name__ == "__main__":
    main()

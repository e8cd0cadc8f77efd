"""layerwise_errors.py PROGRAM OUT DOCUMENT [PANE…]: the layerwise theory against solids; see scripts/layerwise-errors."""

import json
import re
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np

from estimate_scenes import Draw, halton
from estimates import COMPARED, Result, percent
from markers import replace, table
from wide_laminates import Laminate

TOLERANCE = {"layerwise": 1e-3, "solid": 1e-3}
# Multiples of 29, which is none of the other bases, so that consecutive draws also differ in large bases.
NUMBERS = range(29, 552, 29)
# Larger ones are those of meshes: splines would need too many unknowns.
LARGEST_ERROR_OF_SOLID = 2e-3
EDGES = ("free", 1e9, "free", 1e8)
HEAD = ["pane", "impactor", "first contact", "acceleration: error (estimate)", "tension near its peak: error (estimate)", "time", "time of the solid"]
JUDGED = re.compile(r"estimated error of layerwise relative to solid: ([0-9.e+-]+)")


class Pane(Laminate):
    """A laminate whose interlayer has a shear modulus (`material`, Pa) and a bulk modulus of 2 GPa."""

    def interlayer(self):
        return f"bulk = 2e9\nshear = {self.material}\n"

    def named(self):
        return f"{self.material / 1e6:g} MPa"


def drawn(number):
    """A pane by Halton's sequence: 12 to 30 plies wide, hit by 20% to 5 times its mass; every third is hit off its centre."""
    draw = Draw(number)
    ply = draw.between(2, 0.004, 0.01)
    edge = float(f"{ply * 12 * (30 / 12) ** halton(number, 3):.2g}")
    size = (edge, float(f"{edge * draw.one_of(17, (1.0, 1.2, 0.8)):.2g}"))
    point = tuple(float(f"{part * side:.2g}") for part, side in zip(draw.one_of(19, ((0.0, 0.0), (0.15, 0.1), (0.0, 0.0))), size))
    other = float(f"{ply * draw.one_of(23, (1.0, 0.5, 1.0, 1.5)):.2g}")
    layers = (ply, draw.one_of(7, (0.00038, 0.00076, 0.00152)), other)
    mass = float(f"{2500 * size[0] * size[1] * (ply + other) * 0.2 * 25 ** halton(number, 5):.2g}")
    return Pane(size, draw.one_of(13, EDGES), mass, draw.between(37, 0.03, 0.1), draw.between(11, 0.5, 3), point, draw.between(31, 1e6, 1e9), layers=layers)


def run(program, folder, scene, model, end):
    """A result; one that is there is kept."""
    source, result = folder / "scene.toml", folder / f"{model}.{end}.h5"
    source.write_text(scene.text(end))
    if model != "solid" or not result.exists():
        keys = (f"body.model={model}", f"accuracy.tolerance={TOLERANCE[model]}")
        overrides = [word for key in keys for word in ("--set", key)]
        subprocess.run([program, "-q", "run", source, "-o", result, "--force", *overrides], check=True, capture_output=True)
    # The face with the largest tension in the layerwise plate.
    with h5py.File(folder / f"layerwise.{end}.h5") as file:
        largest = {face: series["largest"][:].max() for face, series in file["series/stress"].items() if isinstance(series, h5py.Group)}
    return Result(result, max(largest, key=largest.get))


def estimate(program, source):
    """The estimated error of the theory by `auto`."""
    said = subprocess.run([program, "-q", "check", "--full", "--json", source], check=True, capture_output=True, text=True).stdout
    found = JUDGED.search(json.loads(said)["model"]["reason"])
    return float(found[1]) if found else np.nan


def compared(program, out, number):
    """The row of one pane; none if its solid is not accurate enough."""
    scene, folder, end = drawn(number), out / str(number), 5e-4
    folder.mkdir(parents=True, exist_ok=True)
    while not np.isfinite(first := run(program, folder, scene, "layerwise", end).first_end):
        end *= 2
    kept = folder / "end"
    if not kept.exists():
        kept.write_text(f"{COMPARED * first:.4e}")
    end = kept.read_text()
    try:
        own, solid = (run(program, folder, scene, model, end) for model in ("layerwise", "solid"))
    except KeyError:
        # A mesh has no faces between layers.
        solid = None
    if solid is None or solid.estimates["acceleration"] > LARGEST_ERROR_OF_SOLID:
        print(number, scene.plate(), "left out", flush=True)
        return None
    errors, of_theory = own.errors(solid), estimate(program, folder / "scene.toml")
    error = errors["acceleration"]
    words = [scene.plate(), scene.impactor(), f"{1e3 * first:.2g} ms", f"{percent(error)} ({percent(of_theory)})"]
    words += [f"{percent(errors['tension'])} ({percent(own.estimates['tension'])})", f"{own.seconds:.2g} s", f"{solid.seconds:.2g} s"]
    print(number, *words, f"ratio {of_theory / error:.2f}, estimates {own.estimates['acceleration']:.1e} {solid.estimates['acceleration']:.1e}", flush=True)
    return words


def main():
    program, out, document, *chosen = sys.argv[1:]
    rows = [row for number in map(int, chosen or NUMBERS) if (row := compared(program, Path(out), number))]
    if not chosen:
        replace(document, "layerwise", table(HEAD, rows))


if __name__ == "__main__":
    main()

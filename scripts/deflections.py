"""deflections.py PROGRAM OUT DOCUMENT: estimated against true errors of deflections; see scripts/deflections."""

import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np

from estimate_scenes import MATERIALS, Draw, Scene, halton
from estimates import cubic, percent
from markers import replace, table

TOLERANCE = 1e-2
REFERENCE = 1e-3
SOLID_REFERENCE = 3e-3
SAMPLES = range(1, 25)
# Solids of plates with more thicknesses along an edge take minutes.
WIDEST_SOLID = 16
EDGES = ("free", 1e8, 1e10, "held")
HEAD = ["plate", "impactor", "end", "default: vectors", "default: error (estimate)", "`\"deflection\"`: vectors", "`\"deflection\"`: error (estimate)", "against a solid, without contact (estimate)", "against a solid, in contact (0.3 F/(E h))"]


def drawn(number):
    """Plate, impact and end of a run for a number of Halton's sequence: 8 to 40 thicknesses, hit by 0.6% to 200% of the plate's mass."""
    draw = Draw(number)
    thickness = draw.between(3, 0.005, 0.05)
    edge = float(f"{thickness * 8 * 5 ** halton(number, 2):.2g}")
    size = (edge, float(f"{edge * draw.one_of(17, (1.0, 0.8, 0.6)):.2g}"), thickness)
    support = draw.one_of(13, EDGES)
    places = ((0.0, 0.0), (0.2, 0.1), (0.25, 0.0))
    point = tuple(float(f"{part * side:.2g}") for part, side in zip(draw.one_of(19, places), size))
    young, poisson, density = MATERIALS[draw.material]
    mass = float(f"{density * np.prod(size) * 0.006 * (2 / 0.006) ** halton(number, 5):.2g}")
    radius = float(f"{thickness * 0.5 * 6 ** halton(number, 7):.2g}")
    scene = Scene(size, support, mass, radius, draw.between(11, 0.3, 5), point, draw.material)
    # The lowest angular frequency of the simply supported plate.
    lowest = np.pi**2 * (size[0] ** -2 + size[1] ** -2) * np.sqrt(young * thickness**2 / 12 / (1 - poisson**2) / density)
    return scene, float(f"{2 * np.pi / lowest * 0.5 * 4 ** halton(number, 23):.2g}")


class History:
    """The deflection under the impactor and the contact force of a run."""

    def __init__(self, path):
        with h5py.File(path) as file:
            self.time, contact = file["series/time"][:], file["series/contact"]
            self.deflection, self.force = contact["surface_displacement"][:], contact["force"][:]
            self.estimate = float(file.attrs["deflection_error_estimate"])
            self.vectors, self.theory = file.attrs["reduction"].decode().split()[0], file.attrs["model"].decode()

    def error(self, reference, where=slice(None)):
        """Largest difference from a reference at the steps `where`, divided by the reference's largest deflection."""
        difference = self.deflection - cubic(self.time, reference.time, reference.deflection)
        return np.abs(difference[where]).max() / np.abs(reference.deflection).max()


def run(program, source, model, quantity, tolerance):
    """Runs a scene with a theory, a quantity and a tolerance, and returns its history."""
    result = source.parent / f"{model}-{quantity}-{tolerance}.h5"
    keys = (f"body.model={model}", f"accuracy.quantity={quantity}", f"accuracy.tolerance={tolerance}", "output.stress=false")
    overrides = [word for key in keys for word in ("--set", key)]
    subprocess.run([program, "-q", "run", source, "-o", result, "--force", *overrides], check=True, capture_output=True)
    return History(result)


def against_solid(program, source, scene):
    """Two cells: the largest differences from a solid while the impactor does not touch, and while it touches."""
    if max(scene.size[:2]) > WIDEST_SOLID * scene.size[2]:
        return ["", ""]
    own = run(program, source, "auto", "deflection", TOLERANCE)
    if own.theory == "solid":
        return ["", ""]
    solid = run(program, source, "solid", "deflection", SOLID_REFERENCE)
    forces = own.force, cubic(own.time, solid.time, solid.force)
    without_contact = (forces[0] == 0) & (forces[1] == 0) & (own.time > 0)
    in_contact = (forces[0] > 0) & (forces[1] > 0)
    apart = f"{percent(own.error(solid, without_contact))} ({percent(own.estimate)})" if without_contact.any() else "still in contact"
    young, _, _ = MATERIALS[scene.material]
    local = 0.3 * own.force.max() / (young * scene.size[2]) / np.abs(solid.deflection).max()
    return [apart, f"{percent(own.error(solid, in_contact))} ({percent(local)})"]


def row(program, out, number):
    """One plate: errors against a run with a smaller tolerance, and against a solid."""
    scene, end = drawn(number)
    source = out / str(number) / "scene.toml"
    source.parent.mkdir(parents=True, exist_ok=True)
    source.write_text(scene.text(end))
    reference = run(program, source, "mindlin", "deflection", REFERENCE)
    words = [scene.plate(), scene.impactor(), f"{1e3 * end:g} ms"]
    for quantity in ("acceleration", "deflection"):
        own = run(program, source, "mindlin", quantity, TOLERANCE)
        error = own.error(reference)
        words += [own.vectors, f"{percent(error)} ({percent(own.estimate)})"]
        print(number, quantity, f"{own.estimate / error:.1f}", end=" ")
    words += against_solid(program, source, scene)
    print(*words, flush=True)
    return words


def main():
    program, out, document = sys.argv[1], Path(sys.argv[2]), sys.argv[3]
    replace(document, "deflections", table(HEAD, [row(program, out, number) for number in SAMPLES]))


if __name__ == "__main__":
    main()

"""supports.py PROGRAM OUT DOCUMENT [NUMBER…]: the largest stress in panes that parts of their faces hold; see scripts/supports."""

import resource
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np

from estimate_scenes import Draw
from markers import replace, table

SCENES = range(1, 13)
HEAD = ["pane", "support (part, face, width, modulus)", "loading", "theory", "largest tension, MPa", "reference, MPa", "error (estimate)", "estimate / error", "processor time, s"]
# The reference is of the same theory, on cells of half the size and a longer basis.
REFERENCE = ("accuracy.tolerance=1e-3", "accuracy.cell_factor=0.6")
GLASS = "young = 70e9\npoisson = 0.23\ndensity = 2500.0\n"
LAYERS = """[[body.layer]]
thickness = {ply}
material = "glass"
[[body.layer]]
thickness = 0.00152
material = "interlayer"
[[body.layer]]
thickness = {ply}
material = "glass"
[material.glass]
young = 70e9
poisson = 0.23
density = 2500.0
[material.interlayer]
bulk = 2e9
shear = {shear}
density = 1070.0
"""


class Pane:
    """A pane by Halton's sequence: one layer or three, held by a part of one face or of both, under a load or hit."""

    def __init__(self, number):
        draw = Draw(number)
        self.size = [draw.between(3, 0.5, 1.3), draw.between(5, 0.6, 1.5)]
        self.ply = draw.one_of(2, (0.006, 0.008, 0.01, 0.012))
        self.shear = draw.between(29, 1e6, 2e8) if number % 2 else None
        self.thickness = 2 * self.ply + 0.00152 if self.shear else self.ply
        self.kind = ("discs", "foot", "strips", "rim")[number % 4]
        self.faces = draw.one_of(7, (("bottom",), ("bottom", "top")))
        self.is_pad = self.kind == "rim" and number % 8 == 3
        self.stiffness = draw.between(11, 3e8, 1e10)
        self.width = draw.between(13, 0.02, 0.08)
        self.is_loaded = number % 3 == 0

    def parts(self):
        """The supported parts of a face, as texts of `within`."""
        x, y = (0.5 * edge for edge in self.size)
        if self.kind == "discs":
            at = [0.7 * x, 0.7 * y]
            return [f"{{ disc = {{ centre = [{sx * at[0]}, {sy * at[1]}, {{z}}], radius = {0.5 * self.width} }} }}" for sx in (1, -1) for sy in (1, -1)]
        if self.kind == "foot":
            return [f"{{ box = [[{-x}, {-y}, -1.0], [{x}, {-y + 1.5 * self.width}, 1.0]] }}"]
        if self.kind == "strips":
            inner = 0.8 * y
            ends = [(-inner - self.width / 2, -inner + self.width / 2), (inner - self.width / 2, inner + self.width / 2)]
            return [f"{{ box = [[{-x}, {low}, -1.0], [{x}, {high}, 1.0]] }}" for low, high in ends]
        return [f"{{ rim = {0.5 * self.width} }}"]

    def text(self):
        """The scene."""
        body = f"[body]\nsize = {[*self.size, self.thickness]}\n{GLASS}"
        if self.shear:
            body = f"[body]\nsize = {self.size}\n" + LAYERS.format(ply=self.ply, shear=self.shear)
        supports = ""
        for face in self.faces:
            height = self.thickness / 2 if face == "top" else -self.thickness / 2
            for part in self.parts():
                kind = f'"pad"\nnormal = [0.0, 0.0, {-1.0 if face == "bottom" else 1.0}]' if self.is_pad else '"elastic"'
                stiffness = self.stiffness if self.is_pad else f"[0.0, 0.0, {self.stiffness}]"
                supports += f'[[support]]\nsurface = "{face}"\nwithin = {part.replace("{z}", str(height))}\nkind = {kind}\nstiffness = {stiffness}\n'
        motion = "[impactor]\nmass = 10.0\nradius = 0.15\nspeed = 1.5\n[contact]\nlaw = \"power\"\nstiffness = 2e5\nexponent = 1.0\n[time]\nend = 0.03\n"
        if self.is_loaded:
            motion = '[[load.traction]]\nsurface = "top"\nvalue = [0.0, 0.0, -1500.0]\n[impactor]\nmass = 0.1\nradius = 0.05\nspeed = 1e-3\n'
            motion += '[contact]\nlaw = "power"\nstiffness = 1e3\nexponent = 1.0\n[time]\nend = 5e-3\ninitial = "equilibrium"\n'
        return f'{body}{supports}{motion}[accuracy]\nquantity = "stress"\n'

    def words(self):
        """Pane, supports and motion in words."""
        layers = f"{1e3 * self.ply:g}/1.52/{1e3 * self.ply:g} mm, G = {self.shear:.1g} Pa" if self.shear else f"{1e3 * self.ply:g} mm"
        pane = f"{self.size[0]:g} × {self.size[1]:g} m, {layers}"
        held = f"{self.kind}{' (pad)' if self.is_pad else ''}, {' and '.join(self.faces)}, {1e3 * self.width:.0f} mm, k = {self.stiffness:.0e} N/m³"
        return [pane, held, "1.5 kPa" if self.is_loaded else "10 kg at 1.5 m/s"]


def run(program, folder, name, keys):
    """Largest stress (Pa), its estimate, theory and processor time (s) of a run."""
    result = folder / f"{name}.h5"
    overrides = [word for key in keys for word in ("--set", key)]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([program, "-q", "run", folder / "scene.toml", "-o", result, "--force", *overrides], check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    with h5py.File(result) as file:
        facts = file.attrs
        seconds = after.ru_utime - before.ru_utime
        return float(facts["largest_stress"]), float(facts["stress_error_estimate"]), facts["model"].decode(), seconds


def row(program, out, number):
    """One pane: the default answer against a converged one."""
    pane, folder = Pane(number), out / str(number)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "scene.toml").write_text(pane.text())
    stress, estimate, theory, seconds = run(program, folder, "default", ())
    right, *_ = run(program, folder, "converged", (f"body.model={theory}", *REFERENCE))
    error = abs(stress / right - 1)
    ratio = estimate / error
    print(number, *pane.words(), theory, f"{1e-6 * stress:.3f} {1e-6 * right:.3f} {error:.2e} {estimate:.2e} {ratio:.1f} {seconds:.1f} s", flush=True)
    shown = "none" if np.isnan(estimate) else f"{100 * estimate:.2g}%"
    return [*pane.words(), theory, f"{1e-6 * stress:.2f}", f"{1e-6 * right:.2f}", f"{100 * error:.2g}% ({shown})", f"{ratio:.1f}", f"{seconds:.1f}"]


def main(program, out, document):
    """The table of all panes, or some rows on the terminal."""
    wanted = [int(number) for number in sys.argv[4:]] or SCENES
    rows = [row(program, out, number) for number in wanted]
    if not sys.argv[4:]:
        replace(document, "supports", table(HEAD, rows))


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3]))

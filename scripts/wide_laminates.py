"""wide_laminates.py PROGRAM OUT DOCUMENT: estimated against true errors of wide laminates; see scripts/wide-laminates."""

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from estimate_scenes import MATERIALS, Draw, Scene, halton
from estimates import percent
from markers import replace, table
from panes import HEAD, TOLERANCE, row, run, seconds

REFERENCE = 3e-3
# Multiples of 31, which is none of the bases, so that consecutive draws also differ in large bases.
NUMBERS = range(31, 280, 31)
# Springs of a soft gasket, or none.
EDGES = (5e8, "free")
INTERLAYERS = {
    # As in scenes/laminate.toml, at 20 °C.
    "PVB": """bulk = 2e9
shear = 3.02196e6
prony = [
    { modulus = 6.9339e6, time = 1e-5 },
    { modulus = 3.8986e6, time = 1e-4 },
    { modulus = 2.2892e6, time = 1e-3 },
    { modulus = 1.6727e6, time = 1e-2 },
    { modulus = 0.7616e6, time = 1e-1 },
    { modulus = 2.4010e6, time = 1.0 },
]
""",
    "elastic, 10 MPa": "young = 30e6\npoisson = 0.495\n",
    "elastic, 100 MPa": "young = 300e6\npoisson = 0.495\n",
}


@dataclass(frozen=True)
class Laminate(Scene):
    """Two plies of glass with an interlayer; `size` has the edges, and `material` names the interlayer."""

    layers: tuple = ()
    tension_face: str = "1-lower"

    def text(self, end):
        """As TOML."""
        young, poisson, density = MATERIALS["glass"]
        names = ("glass", "interlayer", "glass")
        layers = "".join(f'[[body.layer]]\nthickness = {h}\nmaterial = "{name}"\n' for h, name in zip(self.layers, names))
        support = "" if self.edge == "free" else f'[[support]]\nsurface = "side"\nkind = "elastic"\nstiffness = [0.0, 0.0, {self.edge}]\n'
        return (
            f"[body]\nsize = {list(self.size)}\n{layers}"
            f"[material.glass]\nyoung = {young}\npoisson = {poisson}\ndensity = {density}\n"
            f"[material.interlayer]\ndensity = 1100\n{self.interlayer()}"
            f"[impactor]\nmass = {self.mass}\nradius = {self.radius}\nyoung = 210e9\npoisson = 0.3\nspeed = {self.speed}\npoint = {list(self.point)}\n"
            f"[time]\nend = {end}\n[output]\nstress = true\n{support}"
        )

    def interlayer(self):
        """Moduli of the interlayer, as TOML."""
        return INTERLAYERS[self.material]

    def named(self):
        """The interlayer in words."""
        return self.material

    def plate(self):
        """Plate and edges in words."""
        edge = self.edge if isinstance(self.edge, str) else f"k = {self.edge:.0e}"
        layers = "/".join(f"{1e3 * h:g}" for h in self.layers)
        return f"{' × '.join(f'{x:g}' for x in self.size)} m, {layers} mm, {self.named()}, {edge}"


@dataclass(frozen=True)
class Window:
    """An impact on a laminate whose echoes are computed in closed form; `end` of the run, s."""

    laminate: Laminate
    end: float


# The first is a pane and the ball of EN 356.
WINDOWS = [
    Window(Laminate((1.1, 0.9), 1e9, 4.11, 0.05, 5.42, (0.0, 0.0), "PVB", layers=(0.004, 0.00076, 0.004)), 5e-3),
    Window(Laminate((1.0, 0.8), 1e9, 0.5, 0.03, 4.0, (0.0, 0.0), "PVB", layers=(0.004, 0.00076, 0.004)), 1e-3),
    Window(Laminate((1.0, 0.8), 1e9, 0.4, 0.025, 3.0, (0.2, 0.1), "PVB", layers=(0.008, 0.00076, 0.003)), 8e-4),
]
HEAD_OF_WINDOWS = ["pane", "impactor", "time simulated", "vectors", "acceleration: difference (estimates)", "tension near its peak", "largest tension", "time"]
# If a strength is given, the basis carries the echoes.
WITHOUT_CLOSED_FORMS = "strength.tension=1e12"


def compared(program, out, number, window):
    """One window: the run with echoes in closed form beside the run without closed forms."""
    folder = out / f"window{number}"
    folder.mkdir(parents=True, exist_ok=True)
    scene, end = window.laminate, window.end
    own, whole = (run(program, folder, scene, "layerwise", end, TOLERANCE, more) for more in ((), (WITHOUT_CLOSED_FORMS,)))
    differences = own.errors(whole)
    cells = [f"{percent(differences[name])} ({percent(own.estimates[name])}, {percent(whole.estimates[name])})" for name in ("acceleration", "tension")]
    vectors = " / ".join(of.reduction.split()[0] for of in (own, whole))
    times = f"{seconds(own)} / {seconds(whole)} s"
    words = [scene.plate(), scene.impactor(), f"{1e3 * end:g} ms", vectors, *cells, percent(differences["largest tension"]), times]
    print(number, *words, flush=True)
    return words


def drawn(number):
    """A laminate by Halton's sequence, hit by a ball of steel of 1% to 8% of the mass of the glass; every third is hit off its centre."""
    draw = Draw(number)
    edge, ply = draw.between(3, 0.35, 0.5), draw.between(2, 0.003, 0.006)
    size = (edge, float(f"{edge * draw.one_of(17, (1.0, 1.3, 0.7)):.2g}"))
    point = tuple(float(f"{part * side:.2g}") for part, side in zip(draw.one_of(19, ((0.0, 0.0), (0.2, 0.1), (0.0, 0.0))), size))
    layers = (ply, draw.one_of(7, (0.00076, 0.00152)), draw.one_of(23, (ply, ply, 1.5 * ply)))
    glass_mass = 2500 * size[0] * size[1] * (layers[0] + layers[2])
    mass = float(f"{glass_mass * 0.01 * 8 ** halton(number, 5):.2g}")
    radius = float(f"{(3 * mass / (4 * np.pi * 7800)) ** (1 / 3):.2g}")
    return Laminate(size, draw.one_of(13, EDGES), mass, radius, draw.between(11, 2, 6), point, draw.one_of(29, tuple(INTERLAYERS)), layers=layers)


def main():
    program, out, document = sys.argv[1], Path(sys.argv[2]), sys.argv[3]
    rows = [row(program, out, number, drawn(number), "layerwise", REFERENCE) for number in NUMBERS]
    replace(document, "wide", table(HEAD, rows))
    windows = [compared(program, out, number, window) for number, window in enumerate(WINDOWS, 1)]
    replace(document, "windows", table(HEAD_OF_WINDOWS, windows))


if __name__ == "__main__":
    main()

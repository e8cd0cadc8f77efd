"""wide_laminates.py PROGRAM OUT DOCUMENT: estimated against true errors of wide laminates; see scripts/wide-laminates."""

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from estimate_scenes import MATERIALS, Draw, Scene, halton
from markers import replace, table
from panes import HEAD, row

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
    # Keeps a hundredth of its modulus, so that the plies come apart during the contact.
    "relaxing": """bulk = 2e9
shear = 8e5
prony = [
    { modulus = 80e6, time = 1e-4 },
    { modulus = 50e6, time = 1e-3 },
    { modulus = 30e6, time = 1e-2 },
    { modulus = 13.6e6, time = 1e-1 },
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


if __name__ == "__main__":
    main()

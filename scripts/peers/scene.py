"""The impact that all peers compute: a central hit on an elastic plate, as in the paper. SI units.

Equation numbers in brackets are the paper's. The peers but the listing spread the force by Hertz's pressure over a disc of
radius r_p, the patch, and take the dent that an elastic half-space has under it out of the contact law, which holds it
already: alpha = q - a.u + c F, c = (3/5) (1 - nu^2) / (E r_p).
"""

import argparse
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from layers import Layer, read_layers


@dataclass(frozen=True)
class Scene:
    """A box centred on the origin, hit in the centre of its top along -z; its four sides may stand on springs.

    It is of one elastic material, or of layers from the top down, whose uppermost and lowest one are of that material.
    """

    size: tuple  # m
    stiffness: float | tuple  # of the support of the sides, N/m3, the same for all three components or one for each
    end: float = 0.01  # s
    young: float = 70e9
    poisson: float = 0.23
    density: float = 2500.0
    mass: float = 52.0  # of the impactor, kg
    radius: float = 0.05
    impactor_young: float = 210e9
    impactor_poisson: float = 0.3
    speed: float = 1.0
    plies: tuple = ()

    @property
    def layers(self):
        """From the top down."""
        return self.plies or (Layer(self.size[2], self.density, *self.lame),)

    @property
    def chain(self):
        """The Maxwell chain of its relaxing layers, which all have the same; None where nothing relaxes."""
        return next((layer.chain for layer in self.plies if layer.chain), None)

    @property
    def lame(self):
        """Lamé's lambda and mu, Pa."""
        return (
            self.young * self.poisson / ((1 + self.poisson) * (1 - 2 * self.poisson)),
            self.young / (2 * (1 + self.poisson)),
        )

    @property
    def hertz_stiffness(self):
        """k0, N/m^1.5: (15)."""
        plate = (1 - self.poisson**2) / self.young
        impactor = (1 - self.impactor_poisson**2) / self.impactor_young
        return 4 / 3 * math.sqrt(self.radius) / (plate + impactor)

    def dent(self, patch):
        """c, m/N: the mean displacement of a half-space under Hertz's pressure over a disc of radius `patch`, by the force."""
        return 0.6 * (1 - self.poisson**2) / (self.young * patch)


def graded(length, first, growth, largest, last):
    """Vertices of cells on [0, length], m: about `first` at 0, growing to `largest`, and about `last` at the other end.

    Along the cells their size grows by `growth` times the distance: s(x) = min(first + growth x, largest, last + growth (length - x)).
    """
    x = np.linspace(0, length, 4001)
    size = np.minimum(np.minimum(first + growth * x, largest), last + growth * (length - x))
    count = np.concatenate([[0], np.cumsum(np.diff(x) * (1 / size[1:] + 1 / size[:-1]) / 2)])
    cells = max(1, round(count[-1]))
    vertices = np.interp(np.linspace(0, count[-1], cells + 1), count, x)
    vertices[0], vertices[-1] = 0.0, length
    return vertices


@dataclass(frozen=True)
class Cells:
    """Bricks of the quarter x, y > 0 and the patch, lengths as fractions of the plate's thickness."""

    order: int
    patch: float  # r_p
    first: float  # cells at the point
    growth: float
    largest: float
    last: float  # cells at the edge
    layers: tuple = (1.0,)  # thicknesses, from the bottom

    def lines(self, scene):
        """Vertices along half of the length, half of the width, and the thickness, m."""
        length, width, thickness = scene.size
        first, largest, last = (thickness * x for x in (self.first, self.largest, self.last))
        across = np.concatenate([[0.0], np.cumsum(self.layers)]) / sum(self.layers) - 0.5
        return [graded(x / 2, first, self.growth, largest, last) for x in (length, width)] + [thickness * across]


def short(step):
    """A step in s as a text: 5e-5."""
    mantissa, exponent = f"{step:e}".split("e")
    return f"{float(mantissa):g}e{int(exponent)}"


def arguments(doc):
    """The scene, the folder for results and the budget of seconds, from the command line that all peers share."""
    parser = argparse.ArgumentParser(description=doc.splitlines()[0])
    parser.add_argument("folder", type=Path, metavar="OUTDIR")
    parser.add_argument("--size", required=True, help="LX,LY,LZ of the plate, m")
    parser.add_argument("--stiffness", type=float, required=True, help="of the support of the sides, N/m3")
    parser.add_argument("--end", type=float, default=0.01, help="s")
    parser.add_argument("--layers", type=Path, metavar="SCENE.toml", help="layers of a scene in the place of one material")
    parser.add_argument("--budget", type=float, default=math.inf, help="begin no point after so many seconds")
    args = parser.parse_args()
    size = tuple(float(x) for x in args.size.split(","))
    plies = read_layers(args.layers, size[2]) if args.layers else ()
    lame = Scene(size, args.stiffness).lame
    if any((layer.lam, layer.mu) != lame for layer in plies if not layer.chain):
        parser.error("--layers: elastic layers must be of the plate's own glass")
    if len({id(layer.chain.times) for layer in plies if layer.chain}) > 1:
        parser.error("--layers: one layer may relax")
    return Scene(size, args.stiffness, args.end, plies=plies), args.folder, args.budget

"""Layers of a laminated pane, and how their materials relax. SI units."""

import tomllib
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Chain:
    """G(t) = G_inf + sum G_i exp(-t / tau_i)."""

    relaxed: float  # G_inf, Pa
    moduli: np.ndarray  # G_i, Pa
    times: np.ndarray  # tau_i, s

    def over(self, step):
        """E = exp(-dt / tau) and phi = (1 - E) tau / dt of each term: of a strain that is linear over a step s+ = E s + phi du is left."""
        decay = np.exp(-step / self.times)
        return decay, -np.expm1(-step / self.times) * self.times / step

    def at_rate(self, rate):
        """What relaxes of G under exp(s t), Pa: sum G_i s tau_i / (1 + s tau_i)."""
        return float(np.sum(self.moduli * rate * self.times / (1 + rate * self.times)))


@dataclass(frozen=True)
class Layer:
    """A layer; of one that relaxes, Lamé's numbers are those of its bulk modulus alone."""

    thickness: float  # m
    density: float
    lam: float  # Pa
    mu: float
    chain: Chain | None = None


def read_layers(path, thickness):
    """The layers of a scene of ricochet's, from the top down, at its temperature; their thickness must be the plate's (m)."""
    scene = tomllib.loads(path.read_text(encoding="utf-8"))
    layers = tuple(
        layer(given["thickness"], scene["material"][given["material"]], scene["body"].get("temperature"))
        for given in scene["body"]["layer"]
    )
    if abs(sum(layer.thickness for layer in layers) - thickness) > 1e-9 * thickness:
        raise SystemExit(f"{path}: its layers are not {thickness} m thick")
    return layers


def layer(thickness, material, temperature):
    """One layer of a material as in a scene."""
    density = material["density"]
    if "young" in material:
        young, poisson = material["young"], material["poisson"]
        lam, mu = young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))
        return Layer(thickness, density, lam, mu)
    moduli, times = (np.array([term[key] for term in material["prony"]]) for key in ("modulus", "time"))
    if "wlf" in material:
        wlf = material["wlf"]
        above = temperature - wlf["reference"]
        times = times * 10 ** (-wlf["c1"] * above / (wlf["c2"] + above))
    return Layer(thickness, density, material["bulk"], 0.0, Chain(material["shear"], moduli, times))

"""Axes for plots of results."""

from __future__ import annotations

from typing import TYPE_CHECKING, Optional

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Letters of all names that fit side by side below a map in a figure of matplotlib's default width.
_LETTERS = 40


def axes_or_new(axes: Optional[Axes]) -> Axes:
    """The axes that are given, or those of a new figure."""
    if axes is not None:
        return axes
    import matplotlib.pyplot as plt

    return plt.subplots(constrained_layout=True)[1]


def label(name: str, units: str) -> str:
    """Name of a quantity with its unit."""
    words = name.replace("/", " ").replace("_", " ")
    return words if units == "1" else f"{words} ({units})"


def is_text(values: np.ndarray) -> bool:
    """Whether these are names, not numbers."""
    return values.dtype.kind == "O"


def turn_names(axes: Axes, names: list[str]) -> None:
    """Turns the names at the x axis where they would run into each other."""
    if sum(map(len, names)) > _LETTERS:
        axes.tick_params(axis="x", labelrotation=30)
        for text in axes.get_xticklabels():
            text.set_horizontalalignment("right")


def edges(values: np.ndarray, is_logarithmic: bool) -> np.ndarray:
    """Where the cells of a map around these values end: half-way between them; names are one apart."""
    if is_text(values):
        return np.arange(len(values) + 1) - 0.5
    values = np.log(values) if is_logarithmic else np.asarray(values, float)
    half = 0.5 * np.diff(values)
    half = half if len(half) else np.array([0.5])
    ends = np.concatenate([values[:1] - half[:1], values[1:] - half[: len(values) - 1], values[-1:] + half[-1:]])
    return np.exp(ends) if is_logarithmic else ends

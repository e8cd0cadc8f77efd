"""Runs and sweeps, read from their files."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Optional, Union

import h5py
import numpy as np

from .drawing import axes_or_new, edges, is_text, label, turn_names

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Path = Union[str, os.PathLike]

#: Columns of contacts.
CONTACT = ["start", "end", "peak_force", "peak_time", "impulse"]


class Run:
    """A run, read into memory; an interrupted run, or one that is being computed, up to its last complete row.

    attributes  the file's attributes: "title", "scene", "model", "error_estimate" (relative to the peak acceleration), "complete", ...
    series      arrays by name with one row a recorded step: "time" (s), "contact/force" (N), "impactor/acceleration" (m/s2), ...; three
                columns for vectors
    contacts    array of records, one a contact: "start" and "end" (s), "peak_force" (N), "peak_time" (s), "impulse" (N s)
    stress_map  the largest tension over time, by face: arrays "points" (m, three columns), "tension" (Pa) and "time" (s) with one row a
                point, NaN where stresses are not read; of a quarter in the part that is modelled. Empty where the run has none
    units       units by name of series and contacts; "1" for a number without unit

    docs/results.md lists the names.
    """

    attributes: dict[str, Any]
    series: dict[str, np.ndarray]
    contacts: np.ndarray
    stress_map: dict[str, dict[str, np.ndarray]]
    units: dict[str, str]

    def __init__(self, path: Path):
        """Reads the result of `ricochet run`. Raises ValueError if the file holds something else."""
        with _open(path) as file:
            if "series/time" not in file:
                raise ValueError(f"{path} is not a run of ricochet")
            self.attributes = _attributes(file)
            self.series, self.units = _series(file["series"])
            self.contacts = _table(file["contacts"], CONTACT)
            self.units |= _units(file["contacts"])
            faces = file["stress_map"].items() if "stress_map" in file else []
            self.stress_map = {face: {name: values[()] for name, values in group.items()} for face, group in faces}

    @property
    def time(self) -> np.ndarray:
        """Times of the recorded steps, s."""
        return self.series["time"]

    def plot(self, name: str = "impactor/acceleration", axes: Optional[Axes] = None, **line: Any) -> Axes:
        """Draws a series (in its SI unit) over the time (in ms), one line a component, the contacts shaded.

        name  of the series, or the last part of it where no other series has that: "force" for "contact/force"
        axes  matplotlib's axes to draw in; without them a new figure is made
        line  what matplotlib's Axes.plot takes: label="k = 1e9", color="black", ...

        Returns the axes, for further runs: b.plot(axes=a.plot()). Raises ValueError if there is no such series.
        """
        name = self._full(name)
        values = self.series[name]
        axes = axes_or_new(axes)
        if values.ndim == 1:
            line.setdefault("label", self.attributes["title"])
        else:
            line.setdefault("label", list("123" if name.endswith("principal_stress") else "xyz"))
        curve, *_ = axes.plot(1e3 * self.time, values, **line)
        for start, end in zip(self.contacts["start"], self.contacts["end"]):
            axes.axvspan(1e3 * start, 1e3 * end, color=curve.get_color(), alpha=0.12, linewidth=0)
        axes.set(xlabel="time (ms)", ylabel=label(name, self.units[name]))
        return axes


    def _full(self, name: str) -> str:
        """The name of a series from that or its last part."""
        if name in self.series:
            return name
        found = [full for full in self.series if full.endswith(f"/{name}")]
        if len(found) != 1:
            raise ValueError(f"the run has no series {name!r}, or several: {', '.join(found or self.series)}")
        return found[0]


class Sweep:
    """A sweep, or a part of one; members that are not computed yet, or have failed, are NaN.

    attributes   the file's attributes: "title", "scene", "complete", ...
    keys         the keys that are varied, the slowest first
    varied       arrays by key: each member's value, numbers in the unit of the key, or texts
    logarithmic  the keys that belong on a logarithmic axis
    members      arrays by name with one entry a member: "peak_force" (N), "peak_acceleration" (m/s2), "impulse" (N s), "status", ...
    contacts     array of records, as of a run, with the column "member"; in the order of the members
    units        units by name of members and contacts, and by key; "1" for a number without unit

    docs/sweep.md lists the names.
    """

    path: Path
    attributes: dict[str, Any]
    keys: list[str]
    varied: dict[str, np.ndarray]
    logarithmic: list[str]
    members: dict[str, np.ndarray]
    contacts: np.ndarray
    units: dict[str, str]

    def __init__(self, path: Path):
        """Reads the result of `ricochet sweep`. Raises ValueError if the file holds something else."""
        with _open(path) as file:
            if _attributes(file).get("kind") != "sweep":
                raise ValueError(f"{path} is not a sweep of ricochet")
            self.path = path
            self.attributes = _attributes(file)
            self.keys = self.attributes["vary"].splitlines()
            values = file["members/vary"]
            self.varied = {key: _values(values[key]) for key in self.keys}
            self.logarithmic = [key for key in self.keys if values[key].attrs["log"]]
            members = file["members"]
            self.members = {name: _values(data) for name, data in members.items() if name != "vary"}
            self.contacts = _table(file["contacts"], ["member", *CONTACT])
            # As long as the sweep goes on they are in the order in which they came, some before their members' status.
            self.contacts = self.contacts[self.done[self.contacts["member"]]]
            self.contacts = self.contacts[np.argsort(self.contacts["member"], kind="stable")]
            self.units = _units(file["contacts"]) | _units(members) | _units(values)

    @property
    def done(self) -> np.ndarray:
        """Whether each member is computed."""
        return self.members["status"] == 1

    def series(self, member: int) -> dict[str, np.ndarray]:
        """The series of a member, as of a run: arrays by name, in SI units.

        Raises KeyError if the sweep was computed without --series, or the member is not computed.
        """
        with _open(self.path) as file:
            path = f"series/{member}"
            if path not in file:
                raise KeyError(f"{self.path} has no series of member {member}: is it done, and was --series given?")
            return _series(file[path])[0]

    def values(self, key: str) -> np.ndarray:
        """The values of a key, each once, in the order in which they were given: those along its dimension of `grid`."""
        given = self.varied[key]
        return np.array(list(dict.fromkeys(given)), given.dtype)

    def grid(self, name: str) -> np.ndarray:
        """A quantity of all members, in its SI unit, as an array with one dimension a key, in the order of `keys`."""
        return self.members[name].reshape([len(self.values(key)) for key in self.keys])

    def plot(self, name: str = "peak_acceleration", axes: Optional[Axes] = None, **style: Any) -> Axes:
        """Draws a quantity in its SI unit: a curve over one key, a map over two. Texts become the names of ticks.

        name   of the quantity, as in `members`
        axes   matplotlib's axes to draw in; without them a new figure is made
        style  what matplotlib's Axes.plot (one key) or Axes.pcolormesh (two keys) takes

        Returns the axes. Raises ValueError for more than two keys.
        """
        if len(self.keys) > 2:
            raise ValueError(f"{self.path} varies {len(self.keys)} keys: one or two can be drawn")
        return self._curve(name, axes, style) if len(self.keys) == 1 else self._map(name, axes, style)

    def _curve(self, name: str, axes: Optional[Axes], style: dict[str, Any]) -> Axes:
        key, quantity = self.keys[0], self.members[name]
        axes, values = axes_or_new(axes), self.varied[key]
        if is_text(values):
            # Names have no order that a line could follow.
            axes.plot(list(values), quantity, **({"marker": "o", "linestyle": "none"} | style))
            names = list(self.values(key))
            # Half a step beyond the first and the last.
            axes.margins(x=0.5 / max(len(names) - 1, 1))
            turn_names(axes, names)
        else:
            axes.plot(values, quantity, ".-", **style)
            axes.set(xscale=self._scale(key))
        axes.set(xlabel=label(key, self.units[key]), ylabel=label(name, self.units[name]))
        return axes

    def _map(self, name: str, axes: Optional[Axes], style: dict[str, Any]) -> Axes:
        grid = self.grid(name)
        axes = axes_or_new(axes)
        values = []
        for dimension, key in enumerate(self.keys):
            along = self.values(key)
            if not is_text(along):
                # Cells of a map follow each other along the axis, in whatever order the values were given.
                order = np.argsort(along)
                along, grid = along[order], grid.take(order, axis=dimension)
            values.append(along)
        y, x = (edges(along, key in self.logarithmic) for along, key in zip(values, self.keys))
        mesh = axes.pcolormesh(x, y, grid, **style)
        for which, key, along in zip("yx", self.keys, values):
            axes.set(**{f"{which}scale": self._scale(key), f"{which}label": label(key, self.units[key])})
            if is_text(along):
                axes.set(**{f"{which}ticks": range(len(along)), f"{which}ticklabels": along})
        if is_text(values[1]):
            turn_names(axes, list(values[1]))
        axes.figure.colorbar(mesh, ax=axes, label=label(name, self.units[name]))
        return axes

    def _scale(self, key: str) -> str:
        return "log" if key in self.logarithmic else "linear"


def _open(path: Path) -> h5py.File:
    """For reading alone: HDF5's lock of a file that is still being written is no obstacle."""
    try:
        return h5py.File(path, "r", locking=False)
    except FileNotFoundError:
        raise FileNotFoundError(f"there is no file {path}") from None
    except OSError as error:
        if not os.path.isfile(path) or h5py.is_hdf5(path):
            raise
        hint = ": ricochet.run computes a scene" if str(path).endswith(".toml") else ""
        raise ValueError(f"{path} is not a result of ricochet{hint}") from error


def _series(group: h5py.Group) -> tuple[dict[str, np.ndarray], dict[str, str]]:
    """All datasets below a group by their paths in it, with as many rows as the time, and their units."""
    data = {}
    group.visititems(lambda path, item: data.update({path: item}) if isinstance(item, h5py.Dataset) else None)
    # The time is written last: where a kill fell into that, others are longer.
    rows = len(data["time"])
    return {path: item[:rows] for path, item in data.items()}, {path: _attributes(item)["units"] for path, item in data.items()}


def _table(group: h5py.Group, columns: list[str]) -> np.ndarray:
    """Columns of one length as an array of records."""
    data = [group[column][:] for column in columns]
    rows = min(map(len, data))
    table = np.empty(rows, [(column, values.dtype) for column, values in zip(columns, data)])
    for column, values in zip(columns, data):
        table[column] = values[:rows]
    return table


def _values(data: h5py.Dataset) -> np.ndarray:
    """Numbers, or texts as Python's."""
    return data[:] if data.dtype.kind in "fiu" else np.array([text.decode() for text in data[:]], dtype=object)


def _attributes(item: h5py.HLObject) -> dict[str, Any]:
    """Attributes, with texts as Python's; a text beyond the length of an attribute is a dataset of bytes."""
    found = {name: value.decode() if isinstance(value, bytes) else value for name, value in item.attrs.items()}
    long = {name: item[name] for name in ("scene", "probes") if isinstance(item, h5py.File) and name in item}
    return found | {name: data[:].tobytes().decode() for name, data in long.items()}


def _units(group: h5py.Group) -> dict[str, str]:
    return {name: _attributes(item)["units"] for name, item in group.items() if isinstance(item, h5py.Dataset)}

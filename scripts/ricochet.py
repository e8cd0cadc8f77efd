"""Results of ricochet in Python: runs and sweeps as numpy arrays, in SI units. Needs h5py, numpy and matplotlib.

    import ricochet
    run = ricochet.Run("plate20.h5")
    run.series["impactor/acceleration"].max(), run.contacts["start"]
    run.plot()
    sweep = ricochet.Sweep("k.h5")
    sweep.grid("peak_force")
    sweep.plot()

docs/results.md and docs/sweep.md say what the names are.
"""

import h5py
import matplotlib.pyplot as plt
import numpy as np

CONTACT = ["start", "end", "peak_force", "peak_time", "impulse"]


class Run:
    """A run, as far as it is written: one that goes on, or was killed, can be read too.

    attributes  those of the root: title, scene, model, error_estimate, complete, ...
    series      arrays by the names below /series: "time", "impactor/acceleration", ...; one row a recorded step
    contacts    an array with a row a contact and the columns start, end, peak_force, peak_time, impulse
    units       by the names of series and contacts
    """

    def __init__(self, path):
        with _open(path) as file:
            if "series/time" not in file:
                raise ValueError(f"{path} is not a run of ricochet")
            self.attributes = dict(file.attrs)
            self.series, self.units = _series(file["series"])
            self.contacts = _table(file["contacts"], CONTACT)
            self.units |= _units(file["contacts"])

    @property
    def time(self):
        """Times of the recorded steps, s."""
        return self.series["time"]

    def plot(self, name="impactor/acceleration", axes=None, **line):
        """Draws a series over the time in ms, one line a component, the contacts shaded; returns the axes."""
        axes = axes or plt.gca()
        values = self.series[name]
        if values.ndim == 1:
            line.setdefault("label", self.attributes["title"])
        else:
            line.setdefault("label", list("123" if name.endswith("principal_stress") else "xyz"))
        curve, *_ = axes.plot(1e3 * self.time, values, **line)
        for start, end in zip(self.contacts["start"], self.contacts["end"]):
            axes.axvspan(1e3 * start, 1e3 * end, color=curve.get_color(), alpha=0.12, linewidth=0)
        axes.set(xlabel="time (ms)", ylabel=_label(name, self.units[name]))
        return axes


class Sweep:
    """A sweep, or a part of one, as far as its members are done.

    attributes  those of the root
    keys        the keys that are varied, the slowest first
    varied      a member's value of each key: arrays by key, of numbers or of texts
    members     arrays by the names below /members: "peak_force", "status", ...; NaN for a member that is not done
    contacts    as of a run, all members' in order, with the column member
    units       by the names of members and contacts, and by key
    """

    def __init__(self, path):
        with _open(path) as file:
            if file.attrs.get("kind") != "sweep":
                raise ValueError(f"{path} is not a sweep of ricochet")
            self.path = path
            self.attributes = dict(file.attrs)
            self.keys = list(file.attrs["vary"])
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
    def done(self):
        """Whether each member is computed."""
        return self.members["status"] == 1

    def series(self, member):
        """The series of a member by name, as of a run; the sweep must have been computed with --series."""
        with _open(self.path) as file:
            path = f"series/{member}"
            if path not in file:
                raise KeyError(f"{self.path} has no series of member {member}: is it done, and was --series given?")
            return _series(file[path])[0]

    def grid(self, name):
        """A quantity of all members by key: as many dimensions as keys, in their order."""
        shape = [len(dict.fromkeys(self.varied[key])) for key in self.keys]
        return self.members[name].reshape(shape)

    def plot(self, name="peak_acceleration", axes=None, **style):
        """Draws a quantity: a curve over one key, a map over two; returns the axes."""
        axes = axes or plt.gca()
        if len(self.keys) > 2:
            raise ValueError(f"{self.path} varies {len(self.keys)} keys: one or two can be drawn")
        scales = ["log" if key in self.logarithmic else "linear" for key in self.keys]
        labels = [_label(key, self.units[key]) for key in self.keys]
        if len(self.keys) == 1:
            axes.plot(self.varied[self.keys[0]], self.members[name], ".-", **style)
            axes.set(xscale=scales[0], xlabel=labels[0], ylabel=_label(name, self.units[name]))
            return axes
        y, x = (_edges(list(dict.fromkeys(self.varied[key])), key in self.logarithmic) for key in self.keys)
        mesh = axes.pcolormesh(x, y, self.grid(name), **style)
        axes.set(xscale=scales[1], xlabel=labels[1], yscale=scales[0], ylabel=labels[0])
        axes.figure.colorbar(mesh, ax=axes, label=_label(name, self.units[name]))
        return axes


def _open(path):
    """For reading alone: HDF5's lock of a file that is still being written is no obstacle."""
    return h5py.File(path, "r", locking=False)


def _series(group):
    """All datasets below a group by their paths in it, with as many rows as the time, and their units."""
    data = {}
    group.visititems(lambda path, item: data.update({path: item}) if isinstance(item, h5py.Dataset) else None)
    # The time is written last: where a kill fell into that, others are longer.
    rows = len(data["time"])
    return {path: item[:rows] for path, item in data.items()}, {path: item.attrs["units"] for path, item in data.items()}


def _table(group, columns):
    data = [group[column][:] for column in columns]
    rows = min(map(len, data))
    table = np.empty(rows, [(column, values.dtype) for column, values in zip(columns, data)])
    for column, values in zip(columns, data):
        table[column] = values[:rows]
    return table


def _values(data):
    """Numbers, or texts as Python's."""
    return data[:] if data.dtype.kind in "fiu" else np.array(data.asstr()[:], dtype=object)


def _units(group):
    return {name: item.attrs["units"] for name, item in group.items() if isinstance(item, h5py.Dataset)}


def _edges(values, is_logarithmic):
    """Where the cells of a map around these values end."""
    values = np.log(values) if is_logarithmic else np.array(values, float)
    half = 0.5 * np.diff(values)
    half = half if len(half) else np.array([0.5])
    edges = np.concatenate([values[:1] - half[:1], values[1:] - half[: len(values) - 1], values[-1:] + half[-1:]])
    return np.exp(edges) if is_logarithmic else edges


def _label(name, units):
    words = name.replace("/", " ").replace("_", " ")
    return words if units == "1" else f"{words} ({units})"

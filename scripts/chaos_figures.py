"""chaos_figures.py OUT DOCS: what scripts/chaos computed into OUT as two figures and four tables of DOCS/chaos.md.

OUT holds sweeps PLATE.NAME.h5 (docs/sweep.md) over the stiffness of the supports, some over a second key.
"""

import sys

import h5py
import matplotlib
import numpy as np

from markers import replace, table

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

PLATES = {"plate100": "1.5 × 1.5 × 0.1 m", "plate40": "1.5 × 1.5 × 0.04 m", "plate20": "0.5 × 0.5 × 0.02 m"}
SMALL = 1e-9  # relative change of speed or mass
VARIANTS = {
    "tolerance": "mindlin, tolerance 1e-4",
    "solid": "solid, tolerance 3e-3",
    "kirchhoff": "kirchhoff",
    "newmark-2e-5": "Newmark, Δt = 2e-5 s",
    "newmark-1e-4": "Newmark, Δt = 1e-4 s",
    "finer": "solid, point load, 40 × 40 cells",
    "coarse": "solid, point load, 20 × 20 cells",
    "paper": "the same with Newmark, Δt = 1e-4 s",
}


class Sweep:
    """A sweep's members, the first key along the first axis."""

    def __init__(self, path):
        with h5py.File(path, "r") as file:
            members = file["members"]
            stiffness = members["vary/support.0.stiffness"][:]
            others = len(stiffness) // len(np.unique(stiffness))
            shape = (-1, others)
            self.stiffness = stiffness.reshape(shape)[:, 0]
            self.done = (members["status"][:] == 1).reshape(shape)
            self.peak = members["peak_acceleration"][:].reshape(shape)
            self.contacts = members["contacts"][:].reshape(shape)
            self.rebound = members["rebound_speed"][:].reshape(shape)
            second = np.full(len(stiffness), np.nan)
            member, start = file["contacts/member"][:], file["contacts/start"][:]
            begins = np.searchsorted(member, np.arange(len(stiffness)))
            several = np.flatnonzero(members["contacts"][:] > 1)
            second[several] = start[begins[several] + 1]
            self.second = second.reshape(shape)

    def every(self, n):
        """Of the stiffnesses of the first column's members, every n-th: peak, number of contacts, second hit."""
        return self.peak[::n, 0], self.contacts[::n, 0], self.second[::n, 0]


def largest(values):
    return np.nanmax(np.abs(values))


def per_cent(value):
    return f"{100 * value:.2g}%"


def converged_table(sweeps):
    """What there is along k."""
    rows = []
    for plate, name in PLATES.items():
        sweep = sweeps[plate, "converged"]
        peak, contacts, _ = sweep.every(1)
        slope = largest(np.diff(np.log(peak)) / np.diff(np.log(sweep.stiffness)))
        rows.append(
            [name, f"{peak.min():.0f} to {peak.max():.0f}", f"{slope:.2f}", f"{contacts.min():.0f} to {contacts.max():.0f}",
             np.count_nonzero(np.diff(contacts))]
        )  # fmt: skip
    return table(["plate", "peak, m/s²", "steepest, ∂ln peak/∂ln k", "contacts", "changes of their number along k"], rows)


def sensitivity_table(sweeps):
    """What a part in 1e9 becomes."""
    rows = []
    for plate, name in PLATES.items():
        for key in ["speed", "mass"]:
            sweep = sweeps[plate, key]
            grown = np.abs(sweep.rebound[:, 1] - sweep.rebound[:, 0]) / SMALL
            again = np.abs(sweep.rebound[:, 2] - sweep.rebound[:, 0]) / (100 * SMALL)
            later = np.abs(sweep.second[:, 1] / sweep.second[:, 0] - 1) / SMALL
            contacts = sweep.contacts[:, 0]
            changed = np.count_nonzero(contacts != sweep.contacts[:, 1])
            rate = np.max(grown ** (1 / contacts))
            unlike = np.max(np.abs(grown - again)) / np.max(grown)
            rows.append(
                [name, key, f"{np.median(grown):.2f}", f"{grown.max():.2f}", f"{rate:.2f}",
                 "–" if np.all(np.isnan(later)) else f"{np.nanmedian(later):.2f}, {np.nanmax(later):.1f}", changed, f"{unlike:.0e}"]
            )  # fmt: skip
    head = ["plate", "changed", "in the final velocity, median", "largest", "factor a contact, at most",
            "in the second hit's time, median and largest", "numbers of contacts changed", "1e-7 differs by"]  # fmt: skip
    return table(head, rows)


def scatter(peak):
    """Median distance of a member from its neighbours' mean, and the 95th percentile, over the median."""
    off = np.abs(peak[1:-1] - 0.5 * (peak[2:] + peak[:-2])) / np.median(peak)
    return np.median(off), np.quantile(off, 0.95)


def variants_table(sweeps, few):
    """What is off by which choice."""
    rows = []
    for plate, name in PLATES.items():
        base = sweeps[plate, "converged"]
        steps = np.abs(np.diff(base.every(1)[0])) / np.median(base.every(1)[0])
        rows.append([f"**{name}**", "converged", len(base.stiffness), "", "", "", f"{np.median(steps):.0e}", f"{scatter(base.every(1)[0])[1]:.0e}"])
        for key, title in VARIANTS.items():
            sweep = sweeps[plate, key]
            is_few = len(sweep.stiffness) < len(base.stiffness)
            peak, contacts, second = base.every(few if is_few else 1)
            mine = sweep.every(1)
            off = np.abs(mine[0] / peak - 1)
            differs = np.count_nonzero(contacts != mine[1]) / len(contacts)
            later = np.abs(mine[2] - second)
            steps = np.abs(np.diff(mine[0])) / np.median(mine[0])
            rows.append(
                ["", title, len(mine[0]), f"{per_cent(np.nanmedian(off))}, {per_cent(np.nanmax(off))}", per_cent(differs),
                 "–" if np.all(np.isnan(later)) else f"{1e3 * np.nanmedian(later):.2g}",
                 "" if is_few else f"{np.median(steps):.0e}", "" if is_few else f"{scatter(mine[0])[1]:.0e}"]
            )  # fmt: skip
    head = ["plate", "", "k", "peak off, median and largest", "other number of contacts", "second hit off, median, ms",
            "neighbours differ, median", "scatter, 95%"]  # fmt: skip
    return table(head, rows)


def separation(path):
    """For each stiffness: times, s, and what the change of the speed has become in the impactor's velocity, over it."""
    with h5py.File(path, "r") as file:
        stiffness = file["members/vary/support.0.stiffness"][::2]
        for index, k in enumerate(stiffness):
            one, other = (file[f"series/{2 * index + n}"] for n in (0, 1))
            time, velocity = one["time"][:], one["impactor/velocity"][:]
            # Steps end with contacts, at times that differ by as little: a tangent leads from one to the other.
            nearest = np.clip(np.searchsorted(other["time"][:], time - 1e-9), 0, len(other["time"]) - 1)
            slope = -other["impactor/acceleration"][:][nearest]
            moved = other["impactor/velocity"][:][nearest] + slope * (time - other["time"][:][nearest])
            contacts = int(file["members/contacts"][2 * index])
            yield k, contacts, time, np.abs(moved - velocity) / SMALL


def growth_figure(sweeps, folder, out):
    """Upper: over k, at the end. Lower: over time."""
    figure, axes = plt.subplots(2, 3, figsize=(16, 9.6), sharey="row", constrained_layout=True)
    rows = []
    for column, (plate, name) in enumerate(PLATES.items()):
        upper, lower = axes[:, column]
        for key, title in [("speed", "speed"), ("mass", "mass")]:
            sweep = sweeps[plate, key]
            grown = np.abs(sweep.rebound[:, 1] - sweep.rebound[:, 0]) / SMALL
            upper.loglog(sweep.stiffness, grown, label=f"by 1e-9 of the {title}", linewidth=1.5)
        upper.set(title=name, xlabel="support stiffness k (N/m³)")
        for k, contacts, time, grown in separation(f"{folder}/{plate}.growth.h5"):
            lower.semilogy(1e3 * time, grown, label=f"k = {k:.0e}, {contacts} contact{'s' if contacts > 1 else ''}", linewidth=1.4)
            rows.append(np.max(grown))
        lower.set(xlabel="time (ms)", xlim=(0, 20))
        lower.legend(fontsize=10, ncol=2, loc="lower right")
        upper.set_ylim(1e-3, 1e1)
        lower.set_ylim(1e-3, 1e1)
    axes[0, 0].legend(fontsize=11, loc="lower left")
    axes[0, 0].set_ylabel("change of the final velocity\nover 1e-9 m/s, or over 1e-9 of the mass (m/s)")
    axes[1, 0].set_ylabel("change of the velocity over 1e-9 m/s,\nby 1e-9 of the speed")
    for axis in axes.flat:
        axis.grid(alpha=0.3)
    figure.savefig(out, dpi=100)
    return max(rows)


def choices_figure(sweeps, out):
    """Peak and second hit over k, converged and by coarser choices."""
    figure, axes = plt.subplots(2, 3, figsize=(16, 9.6), constrained_layout=True)
    looks = {
        "paper": ("Newmark 1e-4 s, point load, 20 × 20 cells", "C2", "^"),
        "newmark-1e-4": ("Newmark 1e-4 s", "C1", "."),
        "newmark-2e-5": ("Newmark 2e-5 s", "C0", "."),
        "converged": ("converged", "black", "."),
    }
    for column, (plate, name) in enumerate(PLATES.items()):
        for key, (title, colour, mark) in looks.items():
            sweep = sweeps[plate, key]
            peak, _, second = sweep.every(1)
            size = 5 if key == "paper" else 2.5
            line = "none" if key == "paper" else "-"
            axes[0, column].semilogx(sweep.stiffness, peak, color=colour, marker=mark, markersize=size, linestyle=line, linewidth=1, label=title)
            axes[1, column].semilogx(sweep.stiffness, 1e3 * second, color=colour, marker=mark, markersize=size, linestyle="none", label=title)
        axes[0, column].set(title=name)
        axes[0, column].set_ylim(bottom=0)
        axes[1, column].set(xlabel="support stiffness k (N/m³)", ylim=(0, 20))
        axes[1, column].set_xlim(axes[0, column].get_xlim())
    axes[0, 0].legend(fontsize=11, loc="lower left")
    axes[0, 0].set_ylabel("peak acceleration (m/s²)")
    axes[1, 0].set_ylabel("second hit (ms)")
    for axis in axes.flat:
        axis.grid(alpha=0.3)
    figure.savefig(out, dpi=100)


def main(folder, docs):
    names = ["converged", "speed", "mass", *VARIANTS]
    sweeps = {(plate, name): Sweep(f"{folder}/{plate}.{name}.h5") for plate in PLATES for name in names}
    failed = sum(np.count_nonzero(~sweep.done) for sweep in sweeps.values())
    if failed:
        print(f"chaos_figures: {failed} members are missing or have failed", file=sys.stderr)
    path = f"{docs}/chaos.md"
    replace(path, "converged", converged_table(sweeps))
    replace(path, "sensitivity", sensitivity_table(sweeps))
    few = (len(sweeps["plate20", "converged"].stiffness) - 1) // (len(sweeps["plate20", "solid"].stiffness) - 1)
    replace(path, "variants", variants_table(sweeps, few))
    most = growth_figure(sweeps, folder, f"{docs}/figures/chaos-growth.png")
    print(f"largest change of the velocity at any time of the histories shown: {most:.2f} of the change of the speed")
    choices_figure(sweeps, f"{docs}/figures/chaos-choices.png")


main(*sys.argv[1:])

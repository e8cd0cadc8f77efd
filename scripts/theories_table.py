"""theories_table.py OUT DOC: what scripts/theories computed into OUT as tables of DOC.

OUT holds reference/PLATE.K.h5 and runs/NAME/PLATE.K.ROUND.h5 with .h5.seconds, the time of the process beside it. NAME is
MODEL.TOLERANCE, or newmark.
"""

import glob
import sys

import h5py
import numpy as np

from markers import replace, table

PLATES = {"plate100": "1.5 × 1.5 × 0.1 m", "plate40": "1.5 × 1.5 × 0.04 m", "plate20": "0.5 × 0.5 × 0.02 m"}
STIFFNESSES = ["0", "1e8", "1e9", "1e10"]
TOLERANCES = ["1e-1", "1e-2", "1e-3"]
BY_HAND = ["half-space", "infinite-plate", "kirchhoff", "mindlin", "solid"]


class Run:
    """A result: series, and what it cost."""

    def __init__(self, path):
        with h5py.File(path, "r") as file:
            self.time, self.acceleration = file["series/time"][:], file["series/impactor/acceleration"][:]
            self.contacts = list(zip(file["contacts/start"][:], file["contacts/end"][:]))
            self.seconds = float(file.attrs["wall_time_total"])
            self.unknowns = int(file.attrs["unknowns"])
            self.model, self.reduction = file.attrs["model"].decode(), file.attrs["reduction"].decode()

    def error(self, reference):
        """Largest difference of the accelerations in the first contact of either, over the reference's peak, at this one's steps: between
        these a straight line is further off than they are."""
        end = max(reference.contacts[0][1], self.contacts[0][1])
        times = self.time[self.time <= end]
        other = np.interp(times, reference.time, reference.acceleration)
        return np.max(np.abs(self.acceleration[: len(times)] - other)) / np.max(reference.acceleration)


class Row:
    """The rounds of one run."""

    def __init__(self, folder, name, plate, k, reference):
        paths = sorted(glob.glob(f"{folder}/runs/{name}/{plate}.{k}.*.h5"))
        runs = [Run(path) for path in paths]
        self.run = runs[0]
        self.seconds = min(run.seconds for run in runs)
        self.process = min(float(open(f"{path}.seconds", encoding="ascii").read()) for path in paths)
        self.error = self.run.error(reference)

    def size(self):
        """Unknowns, and the vectors of their basis."""
        vectors = self.run.reduction.split()[0]
        return "formula" if self.run.unknowns <= 1 else f"{self.run.unknowns:,}" + ("" if vectors == "none" else f" → {vectors}")


def seconds(value):
    return f"{1e3 * value:.0f} ms" if value < 1 else f"{value:.1f} s"


def per_cent(value):
    return f"{100 * value:.2g}%" if value < 1 else f"{value:.1f} ×"


def title(name):
    model, _, tolerance = name.partition(".")
    return (model, tolerance) if tolerance else ("solid, stepped by Newmark", "Δt = 1e-5 s")


def summary(rows):
    """Errors and times: the worst of the stiffnesses."""
    lines = []
    names = ["newmark", "solid.1e-3", "solid.1e-2", "mindlin.1e-2", "kirchhoff.1e-2", "infinite-plate.1e-2", "half-space.1e-2", "auto.1e-1", "auto.1e-2", "auto.1e-3"]
    for name in names:
        cells = []
        for plate in PLATES:
            several = [rows[name, plate, k] for k in STIFFNESSES]
            worst = max(several, key=lambda row: row.error)
            middle = np.median([row.seconds for row in several])
            which = ", ".join(dict.fromkeys(row.run.model for row in several)) + ": " if name.startswith("auto") else ""
            cells.append(f"{which}{worst.size()}, {seconds(middle)}, **{per_cent(worst.error)}**")
        lines.append([*title(name), *cells])
    return table(["model", "tolerance", *PLATES.values()], lines)


def whole(rows, plate):
    """One plate: all runs."""
    lines = []
    for name in [*(f"{model}.{tolerance}" for model in BY_HAND for tolerance in TOLERANCES), "newmark", *(f"auto.{t}" for t in TOLERANCES)]:
        several = [rows[name, plate, k] for k in STIFFNESSES]
        sizes = list(dict.fromkeys(row.size() for row in several))
        which = list(dict.fromkeys(row.run.model for row in several))
        model, tolerance = title(name)
        if model == "auto":
            model = f"auto: {', '.join(which)}"
        times = [row.seconds for row in several]
        process = np.median([row.process for row in several])
        lines.append([model, tolerance, ", ".join(sizes), f"{seconds(min(times))} – {seconds(max(times))}", seconds(process),
                      *(per_cent(row.error) for row in several)])  # fmt: skip
    return table(["model", "tolerance", "unknowns → vectors", "time", "of the process", *(f"k = {k}" for k in STIFFNESSES)], lines)


def auto(rows):
    """Whether auto meets its tolerance, and what it costs against the cheapest choice by hand that does."""
    lines = []
    for plate, name in PLATES.items():
        for tolerance in TOLERANCES:
            chosen = [rows[f"auto.{tolerance}", plate, k] for k in STIFFNESSES]
            ratios, processes = [], []
            for k, row in zip(STIFFNESSES, chosen):
                hand = [rows[f"{model}.{tolerance}", plate, k] for model in BY_HAND]
                fit = [other for other in hand if other.error <= float(tolerance)]
                ratios.append(row.seconds / min(other.seconds for other in fit) if fit else np.nan)
                processes.append(row.process / min(other.process for other in fit) if fit else np.nan)
            met = sum(row.error <= float(tolerance) for row in chosen)
            which = ", ".join(dict.fromkeys(row.run.model for row in chosen))
            lines.append([name, tolerance, which, per_cent(max(row.error for row in chosen)), f"{met} of {len(chosen)}",
                          *("–" if np.all(np.isnan(r)) else f"{np.nanmin(r):.1f} – {np.nanmax(r):.1f}" for r in (ratios, processes))])  # fmt: skip
    return table(["plate", "tolerance", "theory", "largest error", "met", "time over the cheapest by hand that meets it", "ratio of process times"], lines)


def main(folder, doc):
    rows = {}
    names = [*(f"{model}.{tolerance}" for model in [*BY_HAND, "auto"] for tolerance in TOLERANCES), "newmark"]
    for plate in PLATES:
        for k in STIFFNESSES:
            reference = Run(f"{folder}/reference/{plate}.{k}.h5")
            for name in names:
                rows[name, plate, k] = Row(folder, name, plate, k, reference)
    replace(doc, "theories", summary(rows))
    for plate in PLATES:
        replace(doc, plate, whole(rows, plate))
    replace(doc, "auto", auto(rows))


main(*sys.argv[1:])

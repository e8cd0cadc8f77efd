"""estimates.py PROGRAM OUT DOCUMENT [SCENE…]: estimated against true errors of acceleration and tension; see scripts/estimates."""

import itertools
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np

from estimate_scenes import FITTED, PLATES, WITH_TENSION_REFERENCE, SCENES
from markers import replace, table

TOLERANCE = 1e-2
# A theory that is named has no estimate of its own error: the reference of its acceleration is of the same theory. That of `auto` is the solid.
THEORIES = {"mindlin": "mindlin", "solid": "solid", "auto": "solid"}
# Tolerances of the reference of the acceleration, and of the second reference.
REFERENCES = {"mindlin": ("1e-5", "3e-5"), "solid": ("1e-4", "3e-4")}
# Part of the largest tension from which a tension is near it, as the program has it.
NEAR_PEAK = 0.9
# The ratios of estimate and error that are counted as too large.
QUANTITIES = {"acceleration": 6.0, "tension": 5.0}
# The part of the first contact that is compared: its end itself is another one in each run.
COMPARED = 0.99


class Result:
    """One run: its histories up to the end of the first contact, and what the program says of their errors."""

    def __init__(self, path, face="lower"):
        with h5py.File(path) as file:
            ends, is_open = file["contacts/end"][:], bool(file["contacts"].attrs["open_at_end"])
            self.first_end = np.inf if len(ends) == 0 or (is_open and len(ends) == 1) else float(ends[0])
            self.time = file["series/time"][:]
            self.acceleration = file["series/impactor/acceleration"][:]
            self.tension = file[f"series/stress/{face}/largest"][:]
            facts = file.attrs
            self.estimates = {"acceleration": float(facts["error_estimate"]), "tension": float(facts["stress_error_estimate"])}
            self.theory, self.seconds = facts["model"].decode(), float(facts["wall_time_total"])
            self.reduction = facts["reduction"].decode()

    def errors(self, reference):
        """Largest difference of the acceleration over its peak; that of the tension on the lower face, linear between the recorded steps,
        at times at which it is near its peak; and the difference of the largest tensions."""
        difference = np.abs(self.acceleration - cubic(self.time, reference.time, reference.acceleration))
        peak, time = reference.tension.max(), np.union1d(self.time, reference.time)
        own, others = np.interp(time, self.time, self.tension), cubic(time, reference.time, reference.tension)
        is_near = (own > NEAR_PEAK * self.tension.max()) | (others > NEAR_PEAK * peak)
        return {
            "acceleration": difference.max() / reference.acceleration.max(),
            "tension": np.abs(own - others)[is_near].max() / peak,
            "largest tension": abs(self.tension.max() / peak - 1),
        }


def cubic(at, x, y):
    """The piecewise cubic with the slopes of parabolas through three points."""
    step = np.diff(x)
    slope = np.diff(y) / step
    inner = (slope[:-1] * step[1:] + slope[1:] * step[:-1]) / (step[1:] + step[:-1])
    slopes = np.concatenate([[slope[0]], inner, [slope[-1]]])
    i = np.clip(np.searchsorted(x, at) - 1, 0, len(step) - 1)
    h, t = step[i], np.clip((at - x[i]) / step[i], 0, 1)
    value = y[i] * (1 + 2 * t) * (1 - t) ** 2 + y[i + 1] * t**2 * (3 - 2 * t)
    return value + h * (slopes[i] * t * (1 - t) ** 2 - slopes[i + 1] * t**2 * (1 - t))


class Runs:
    """Runs of one scene; references are kept."""

    def __init__(self, program, out, number):
        self.program, self.folder, self.number, self.scene = program, out / str(number), number, SCENES[number - 1]
        self.folder.mkdir(parents=True, exist_ok=True)

    def run(self, name, end, model, tolerance, keep=False, more=()):
        """A result, with more keys of the scene; one that is kept is made once."""
        scene, result = self.folder / f"{name}.toml", self.folder / f"{name}.h5"
        text = self.scene.text(end)
        if not (keep and result.exists() and scene.exists() and scene.read_text() == text):
            scene.write_text(text)
            result.unlink(missing_ok=True)
            keys = (f"body.model={model}", f"accuracy.tolerance={tolerance}", *more)
            overrides = [word for key in keys for word in ("--set", key)]
            subprocess.run([self.program, "-q", "run", scene, "-o", result, "--force", *overrides], check=True, capture_output=True)
        return Result(result)

    def references(self, end, theory):
        """For each quantity the reference and another one, whose difference says how good it is. Those of the tension are solids for every
        theory, with the force on a narrower disc."""

        def run(theory, tolerance, part=1.0):
            disc = [f"contact.disc_radius={part * self.scene.disc():.6g}"] if part < 1 else []
            return self.run(f"reference-{theory}-{tolerance}-{part:g}", end, theory, tolerance, keep=True, more=disc)

        references = {"acceleration": [run(theory, tolerance) for tolerance in REFERENCES[theory]]}
        if self.number in WITH_TENSION_REFERENCE:
            references["tension"] = run("solid", "3e-4", 0.25), run("solid", "1e-4", 0.5)
        return references

    def theories(self):
        """The theories that are judged: thick boxes are no plates."""
        return THEORIES if self.number <= len(PLATES) else {"solid": "solid"}

    def end(self):
        """Somewhat less than the first contact, s."""
        end, theory = 5e-4, next(iter(self.theories()))
        while not np.isfinite(first := self.run("end", end, theory, "1e-2", keep=True).first_end):
            end *= 4
        return float(f"{COMPARED * first:.4e}")


def judge(program, out, number):
    """Rows of one scene, a theory each."""
    runs = Runs(program, out, number)
    end_file = runs.folder / "end"
    if not end_file.exists():
        end_file.write_text(str(runs.end()))
    end = float(end_file.read_text())
    rows = []
    for model, theory in runs.theories().items():
        references = runs.references(end, theory)
        result = runs.run(model, end, model, TOLERANCE)
        row = {"scene": number, "model": model, "theory": result.theory, "seconds": result.seconds}
        for quantity, (reference, other) in references.items():
            errors, own = result.errors(reference), other.errors(reference)[quantity]
            row[quantity] = {"error": errors[quantity], "estimate": result.estimates[quantity], "own": own}
        if "tension" in row:
            row["tension"]["of largest"] = errors["largest tension"]
        rows.append(row)
        words = [f"{q} {r['error']:.1e} (reference {r['own']:.0e}) estimated {r['estimate']:.1e}" for q, r in ((q, row[q]) for q in references)]
        print(number, model, result.theory, *words, f"{result.seconds:.2f} s", flush=True)
    return rows


def percent(x):
    """Per cent with two digits, or without decimals from 100%; an error without estimate is NaN."""
    if np.isnan(x):
        return "not estimated"
    return f"{100 * x:.0f}%" if x >= 1 else f"{100 * x:.2g}%"


def ratios(rows, quantity, floor=0.0):
    """Estimated over true errors, not below the floor."""
    return np.array([row[quantity]["estimate"] / max(row[quantity]["error"], floor) for row in rows])


def counted(rows, quantity, models):
    """Rows of a quantity: stresses have no limit at clamped edges, and the estimate is for those under the hit."""
    is_counted = {"acceleration": lambda scene: True, "tension": lambda scene: scene.edge != "clamped"}[quantity]
    return [row for row in rows if row["model"] in models and quantity in row and is_counted(SCENES[row["scene"] - 1])]


def summary(rows, quantity, model, name):
    """A line of the first table."""
    errors, raw, floored = [r[quantity]["error"] for r in rows], ratios(rows, quantity), ratios(rows, quantity, TOLERANCE / 20)
    of_largest = [r[quantity]["of largest"] for r in rows] if quantity == "tension" else []
    return [quantity, f"`{model}`", name, len(rows), f"{percent(np.median(errors))}; {percent(max(errors))}",
            f"{percent(np.median(of_largest))}; {percent(max(of_largest))}" if of_largest else "",
            f"{raw.min():.1f}; {np.median(raw):.1f}; {np.quantile(raw, 0.9):.1f}; {raw.max():.1f}",
            f"{floored.min():.1f}; {np.median(floored):.1f}; {np.quantile(floored, 0.9):.1f}; {floored.max():.1f}",
            int((raw < 1).sum()), int((raw > QUANTITIES[quantity]).sum())]  # fmt: skip


def tables(rows, document):
    """Each quantity and theory in two lines, and the three smallest and five largest ratios."""
    groups = {
        "yes": lambda number: number <= FITTED,
        "no": lambda number: FITTED < number <= len(PLATES),
        "no, thick boxes": lambda number: number > len(PLATES),
    }
    lines = []
    for quantity, model, (name, is_in) in itertools.product(QUANTITIES, THEORIES, groups.items()):
        of_group = [row for row in counted(rows, quantity, [model]) if is_in(row["scene"])]
        if of_group:
            lines.append(summary(of_group, quantity, model, name))
    head = ["quantity", "theory", "used to fit", "scenes", "error: median; largest", "of the largest tension alone", "estimate/error: least; median; 9 of 10; largest",
            "estimate/max(error, 0.05%)", "below 1", "ratio above 6 (tension: 5)"]  # fmt: skip
    replace(document, "estimates", table(head, lines))
    lines = []
    for quantity in QUANTITIES:
        of_named = counted(rows, quantity, ["mindlin", "solid"])
        order = np.argsort(ratios(of_named, quantity))
        for row in (of_named[i] for i in (*order[:3], *order[-5:])):
            scene, of = SCENES[row["scene"] - 1], row[quantity]
            lines.append([quantity, row["scene"], scene.plate(), scene.impactor(), f"`{row['model']}`", percent(of["error"]), percent(of["own"]),
                          percent(of["estimate"]), f"{of['estimate'] / of['error']:.1f}"])  # fmt: skip
    head = ["quantity", "scene", "plate", "impactor, hit at", "theory", "error", "the references' difference", "estimate", "ratio"]
    replace(document, "estimates-extremes", table(head, lines))


def main(program, out, document):
    wanted = [int(number) for number in sys.argv[4:]] or range(1, len(SCENES) + 1)
    rows = [row for number in wanted for row in judge(program, out, number)]
    if not sys.argv[4:]:
        tables(rows, document)


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3]))

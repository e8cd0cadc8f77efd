"""temperatures.py PROGRAM OUT DOCUMENT: a thousand temperatures of a laminate; see scripts/temperatures."""

import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from statistics import median

import h5py
import numpy as np

from estimates import percent
from markers import replace, table

SCENE = "scenes/laminate.toml"
# A step of 0.05 °C, so that whole degrees are among the members. Bodies are made at least at
# every eighth of the range; the temperatures compared are between them.
VALUES = "0..50:1001"
COMPARED_TEMPERATURES = range(3, 50, 10)
REFERENCE_TOLERANCE = 2e-3
# Single runs before the sweep, and again after it.
RUNS = 5
HEAD = ["pane", "one run, one rank", "1,001 temperatures, two ranks", "peak of the first contact: largest error of five (estimate there)", "largest tension: largest error of five (estimate there)"]


@dataclass(frozen=True)
class Pane:
    """The pane of the scene; `keys` replace some of the scene's."""

    description: str
    keys: tuple

    def command(self, program, *more):
        """A command with the scene and its keys."""
        return [program, "-q", more[0], SCENE, *(word for key in self.keys for word in ("--set", key)), *map(str, more[1:])]


PANES = [
    Pane("on springs, 5 kg at 2 m/s, 5 ms", ()),
    Pane("free, 52 kg at 1 m/s, 8 ms", ("support=", "impactor.mass=52.0", "impactor.speed=1.0", "time.end=0.008")),
]


def timed(command):
    """Wall time of a command, s."""
    begin = time.monotonic()
    subprocess.run(command, check=True, capture_output=True)
    return time.monotonic() - begin


def row(program, out, number, pane):
    """One pane: times, and errors at some temperatures."""
    result, single = out / f"{number}.h5", out / f"{number}-run.h5"
    result.unlink(missing_ok=True)
    sweep = ["mpirun", "-n", "2", *pane.command(program, "sweep", "--vary", f"body.temperature={VALUES}", "-o", result)]
    run = pane.command(program, "run", "-o", single, "--force")
    runs = [timed(run) for _ in range(RUNS)]
    seconds = timed(sweep)
    runs += [timed(run) for _ in range(RUNS)]
    with h5py.File(result) as file:
        members = {name: file["members"][name][:] for name in ("vary/body.temperature", "largest_stress", "first_contact_error", "stress_error_estimate")}
        # The contacts are listed member by member.
        contacts = file["members/contacts"][:].astype(int)
        peaks = file["contacts/peak_force"][:][np.cumsum(contacts) - contacts]
    peak_errors, tension_errors, peak_estimates, tension_estimates = [], [], [], []
    for degrees in COMPARED_TEMPERATURES:
        keys = (f"body.temperature={degrees}.0", "body.model=layerwise", f"accuracy.tolerance={REFERENCE_TOLERANCE}")
        subprocess.run(run + [word for key in keys for word in ("--set", key)], check=True, capture_output=True)
        member = np.argmin(abs(members["vary/body.temperature"] - degrees))
        with h5py.File(single) as file:
            peak_errors.append(abs(peaks[member] / file["contacts/peak_force"][0] - 1))
            tension_errors.append(abs(members["largest_stress"][member] / file.attrs["largest_stress"] - 1))
        peak_estimates.append(members["first_contact_error"][member])
        tension_estimates.append(members["stress_error_estimate"][member])
    worst, worst_tension = int(np.argmax(peak_errors)), int(np.argmax(tension_errors))
    cells = [
        pane.description,
        f"{median(runs):.2g} s",
        f"{seconds:.2g} s",
        f"{percent(peak_errors[worst])} ({percent(peak_estimates[worst])})",
        f"{percent(tension_errors[worst_tension])} ({percent(tension_estimates[worst_tension])})",
    ]
    print(*cells, peak_errors, tension_errors, flush=True)
    return cells


def main():
    program, out, document = sys.argv[1], Path(sys.argv[2]), sys.argv[3]
    replace(document, "temperatures", table(HEAD, [row(program, out, number, pane) for number, pane in enumerate(PANES)]))


if __name__ == "__main__":
    main()

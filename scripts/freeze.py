"""freeze.py SAVED PROGRAM OUT: compares two builds of the program; see scripts/freeze."""

import os
import re
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np

# Plates of the paper, as it solves them: on one rank, each series must be the same bit for bit.
PAPER = [(plate, stiffness) for plate in ("plate20", "plate40") for stiffness in ("0", "1e9")]

WINDOW = """[body]
young = 70e9
poisson = 0.23
density = 2500.0
size = [1.0, 1.5, 0.008]
[[support]]
surface = "side"
kind = "elastic"
stiffness = [0.0, 0.0, 5e8]
[impactor]
mass = 4.11
radius = 0.05
young = 210e9
poisson = 0.3
speed = 7.672
[time]
end = 0.02
"""

# What a plate of the paper leaves to the program by default.
AUTO = ["body.model=auto", "body.reduction=", "body.cells=", "body.order=", "body.symmetry=", "contact=", "time.scheme=", "time.step=", "solver="]

# Scenes, with keys that are set, and whether instructions are counted.
SCENES = [
    ("scenes/pane.toml", [], True),
    ("window", [], True),
    ("window", ["strength.tension=45e6"], True),
    ("window", ["impactor.point=[0.13, 0.21, 0.004]"], False),
    ("scenes/laminate.toml", [], True),
    ("scenes/laminate5.toml", [], False),
    ("scenes/points.toml", [], False),
    ("scenes/strips.toml", [], False),
    ("scenes/pendulum.toml", [], False),
    *((f"scenes/{plate}.toml", AUTO, False) for plate in ("plate20", "plate40", "plate100")),
]


def run(program, scene, result, keys, before=()):
    """Runs a scene; returns what the program and a command before it said."""
    overrides = [word for key in keys for word in ("--set", key)]
    command = [*before, program, "-q", "run", scene, "-o", result, "--force", *overrides]
    done = subprocess.run(command, capture_output=True, text=True, env=os.environ | {"OMP_NUM_THREADS": "1"})
    if done.returncode:
        raise SystemExit(f"{' '.join(map(str, command))}: status {done.returncode}\n{done.stderr}")
    return done.stderr


def series(result):
    """All series of a result, by name."""
    found = {}
    with h5py.File(result) as file:
        file["series"].visititems(lambda name, of: found.update({name: of[...]}) if isinstance(of, h5py.Dataset) else None)
    return found


def digits(programs, out):
    """Whether the paper's path is the same, bit for bit; else the largest difference over the largest value."""
    for plate, stiffness in PAPER:
        keys = ["time.end=4e-3", f"support.0.stiffness={stiffness}" if stiffness != "0" else "support=[]"]
        results = []
        for name, program in programs.items():
            results.append(out / f"{plate}-{stiffness}-{name}.h5")
            run(program, f"scenes/{plate}.toml", results[-1], keys)
        saved, own = map(series, results)
        changed = [name for name in saved if not np.array_equal(own[name], saved[name], equal_nan=True)]
        apart = {name: np.abs(own[name] - saved[name]).max() / (np.abs(saved[name]).max() or 1) for name in changed}
        print(f"{plate}, k = {stiffness}:", apart or "bit for bit", flush=True)


def numbers(result):
    """Peak force, largest tension and the estimated errors, as the result has them."""
    with h5py.File(result) as file:
        force, of = file["series/contact/force"][...], file.attrs
        errors = [round(float(of[name]), 5) for name in ("first_contact_error", "error_estimate", "stress_error_estimate") if name in of]
        return force.max(), of.get("largest_stress", np.nan), errors, of.get("reduction", b"").decode()


def instructions(program, scene, out, keys):
    """Instructions of a run, in millions."""
    counted = ("valgrind", "--tool=callgrind", f"--callgrind-out-file={out}/callgrind")
    said = run(program, scene, out / "counted.h5", keys, counted)
    return int(re.search(r"Collected : (\d+)", said)[1]) / 1e6


def main():
    programs, out = dict(zip(("saved", "own"), sys.argv[1:3])), Path(sys.argv[3])
    digits(programs, out)
    (out / "window.toml").write_text(WINDOW)
    for scene, keys, is_counted in SCENES:
        path = out / "window.toml" if scene == "window" else scene
        print(scene, *keys)
        counts = []
        for name, program in programs.items():
            run(program, path, out / f"{name}.h5", keys)
            force, tension, errors, vectors = numbers(out / f"{name}.h5")
            counts.append(instructions(program, path, out, keys) if is_counted else np.nan)
            print(f"  {name:6} {force:.6g} N, {1e-6 * tension:.5g} MPa, errors {errors}, {vectors}, {counts[-1]:.0f} million instructions", flush=True)
        if is_counted:
            print(f"  ratio of instructions {counts[1] / counts[0]:.2f}")


if __name__ == "__main__":
    main()

"""scaling_table.py OUT DOC: what scripts/scaling measured into OUT as tables of DOC."""

import csv
import glob
import multiprocessing
import os
import re
import sys
import time

import h5py
import numpy as np

from markers import replace, table

NAMES = {"one": "one rank", "strong": "strong", "weak": "weak", "million": "a million"}
PHASES = {"mesh and matrices": "wall_time_model", "solver and w": "wall_time_setup", "a step": "wall_time_steps"}


def read_rate(barrier, rates):
    """Bytes a second that this process reads while the others do: sums of an array that no cache holds."""
    array = np.ones(1 << 27)
    barrier.wait()
    begin = time.perf_counter()
    for _ in range(8):
        array.sum()
    rates.put(8 * array.nbytes / (time.perf_counter() - begin))


def bandwidth(processes):
    """Bytes a second that all read at once."""
    barrier, rates = multiprocessing.Barrier(processes), multiprocessing.Queue()
    all_ = [multiprocessing.Process(target=read_rate, args=(barrier, rates)) for _ in range(processes)]
    for process in all_:
        process.start()
    total = sum(rates.get() for _ in all_)
    for process in all_:
        process.join()
    return total


class Run:
    """One run of scripts/scaling."""

    def __init__(self, path):
        self.name, ranks, _ = os.path.basename(path).split(".")
        self.ranks = int(ranks)
        stem = path.removesuffix(".h5")
        with h5py.File(path, "r") as file:
            at = file.attrs
            self.unknowns, self.solves = int(at["unknowns"]), int(at["solves"])
            self.times = {phase: float(at[key]) for phase, key in PHASES.items()}
        self.times["a step"] /= self.solves
        self.memory = sum(float(open(f, encoding="ascii").read()) for f in glob.glob(f"{stem}.memory.*"))
        self.predicted = float(re.search(r"memory +about (\d+) MB", open(f"{stem}.check", encoding="utf-8").read())[1]) * 1e6
        log = open(f"{stem}.log", encoding="utf-8", errors="replace").read()
        # After that of w; the first step has nothing to solve for.
        self.iterations = [int(n) for n in re.findall(r"converged due to \w+ iterations (\d+)", log)][2:]


def short(seconds):
    return f"{1e3 * seconds:.0f} ms" if seconds < 1 else f"{seconds:.1f} s"


def runs_table(runs):
    head = ["", "unknowns", "ranks", *PHASES, "iterations a solve", "an iteration", "memory", "predicted"]
    lines = []
    for run in runs:
        least, most = min(run.iterations), max(run.iterations)
        times = [short(run.times[phase]) for phase in PHASES]
        memory = [f"{value / 1e9:.1f} GB" for value in (run.memory, run.predicted)]
        lines.append([NAMES[run.name], f"{run.unknowns:,}", run.ranks, *times, f"{least} to {most}", short(run.times["a step"] / np.mean(run.iterations)), *memory])
    return table(head, lines)


def model(runs):
    """t = σ n + q n/p for each phase, by least squares of relative errors; an iteration in the place of a step."""
    lines = []
    for phase in PHASES:
        values = np.array([run.times[phase] / (np.mean(run.iterations) if phase == "a step" else 1) for run in runs])
        sizes = np.array([[run.unknowns, run.unknowns / run.ranks] for run in runs], float) / values[:, None]
        (serial, shared), *_ = np.linalg.lstsq(sizes, np.ones(len(runs)), rcond=None)
        if serial < 0:
            (serial, shared) = 0, np.linalg.lstsq(sizes[:, 1:], np.ones(len(runs)), rcond=None)[0][0]
        off = np.abs(sizes @ [serial, shared] - 1).max()
        name = "an iteration" if phase == "a step" else phase
        half = "–" if serial == 0 else f"{shared / serial:.{1 if shared < 10 * serial else 0}f}"
        lines.append([name, f"{1e6 * serial:.2f}", f"{1e6 * shared:.2f}", f"{100 * off:.0f}%", half])
    return table(["", "σ, µs", "q, µs", "largest error of the fit", "q/σ: number of ranks at which half of the time is not parallel"], lines)


def peer_table(path):
    """NGSolve's conjugate gradients on the first body."""
    head = ["preconditioner", "unknowns", "threads", "before the steps", "a step", "iterations a solve", "force at the end"]
    with open(path, encoding="utf-8") as file:
        rows = [
            [
                f"`{row['preconditioner']}`", f"{int(row['unknowns']):,}", row["threads"], short(float(row["before"])), short(float(row["step"])),
                f"{row['least']} to {row['most']}", f"{float(row['force']):.0f} N",
            ]
            for row in csv.DictReader(file)
        ]
    return table(head, rows)


def main(folder, doc):
    runs = [Run(path) for path in sorted(glob.glob(f"{folder}/*.h5"), key=lambda p: "oswm".index(os.path.basename(p)[0]))]
    replace(doc, "scaling", runs_table(runs))
    replace(doc, "scaling-peer", peer_table(f"{folder}/peer.csv"))
    one, two = bandwidth(1), bandwidth(2)
    rates = f"Read bandwidth of one core {one / 1e9:.1f} GB/s, of two at once {two / 1e9:.1f} GB/s: {two / one:.2f} times."
    replace(doc, "scaling-model", model([run for run in runs if run.name != "million"]) + "\n\n" + rates)


if __name__ == "__main__":
    main(*sys.argv[1:])

"""performance_table.py OUT DOC: what scripts/performance measured into OUT as tables of DOC."""

import glob
import re
import sys
import time

import h5py
import numpy as np

from markers import replace, table

CELLS = ["10,10,1", "20,20,1", "20,20,2", "30,30,2", "30,30,3"]
RANKS = [1, 2]


def bandwidth():
    """Bytes a second that one core reads: sums of an array that no cache holds."""
    array = np.ones(1 << 27)
    times = []
    for _ in range(5):
        begin = time.perf_counter()
        array.sum()
        times.append(time.perf_counter() - begin)
    return array.nbytes / min(times)


def costs(folder, cells, ranks):
    """Unknowns, and the shortest times of assembly, factorisation and a step."""
    rows = []
    for path in glob.glob(f"{folder}/{cells}.{ranks}.*.h5"):
        with h5py.File(path, "r") as file:
            at = file.attrs
            step = at["wall_time_steps"] / at["solves"]
            rows.append([at["unknowns"], at["wall_time_model"], at["wall_time_setup"], step])
    return np.min(rows, axis=0)


def factor(folder, cells):
    """Entries of a factor, as expected before it is made."""
    text = open(f"{folder}/{cells}.check", encoding="utf-8").read()
    return float(re.search(r"([\d.e]+) in a factor", text)[1])


def short(seconds):
    return f"{1e3 * seconds:.2f} ms" if seconds < 0.1 else f"{seconds:.2f} s"


def growth(folder):
    lines, all_costs = [], {}
    rate = bandwidth()
    for cells in CELLS:
        one, two = (costs(folder, cells, ranks) for ranks in RANKS)
        all_costs[cells] = (one, two)
        # Both triangles of the factor are read once, 8 bytes an entry.
        bound = 2 * 8 * factor(folder, cells) / rate
        times = [f"{short(a)} ({a / b:.2f})" for a, b in zip(one[1:], two[1:])]
        lines.append([cells.replace(",", "×"), f"{int(one[0]):,}", *times, short(bound), f"{one[3] / bound:.1f}"])
    slopes = []
    unknowns = np.log([all_costs[cells][0][0] for cells in CELLS])
    for column in range(1, 4):
        values = np.log([all_costs[cells][0][column] for cells in CELLS])
        slopes.append(f"n^{np.polyfit(unknowns, values, 1)[0]:.2f}")
    lines.append(["slope", "", *slopes, "", ""])
    head = ["cells", "unknowns n", "assembly, all (speed-up on 2 ranks)", "factorisation", "a step", "bandwidth bound of its solve", "step / bound"]
    return table(head, lines) + f"\n\nRead bandwidth of one core: {rate / 1e9:.1f} GB/s."


def assembly(folder):
    """Ours over FEniCS's."""
    text = open(f"{folder}/fenics", encoding="utf-8").read()
    fenics = {}
    for cells, which, first, again in re.findall(r"(\S+) Q2, \d+ unknowns, ([KM]): first ([\d.]+) s, again ([\d.]+) s", text):
        before = fenics.get(cells, (0.0, 0.0))
        fenics[cells] = (before[0] + float(first), before[1] + float(again))
    lines = []
    ours = open(f"{folder}/assembly", encoding="utf-8").read()
    for cells, unknowns, one, two in re.findall(r"hexahedra (\S+), (\d+) unknowns: assembly ([\d.]+) s on 1 rank, ([\d.]+) s", ours):
        first, again = fenics.get(cells, (None, None))
        cells_ = [f"{first:.2f} s", f"{again:.2f} s", f"{first / float(one):.1f}"] if first else ["–"] * 3
        lines.append([cells, f"{int(unknowns):,}", *cells_[:2], f"{one} s", cells_[2], f"{two} s"])
    head = ["cells", "unknowns", "FEniCS, K and M", "again, pattern kept", "ricochet", "FEniCS over it", "on 2 ranks"]
    return table(head, lines)


def main(folder, doc):
    replace(doc, "growth", growth(folder))
    replace(doc, "assembly", assembly(folder))
    step = open(f"{folder}/step", encoding="utf-8").read().strip()
    replace(doc, "step", f"```text\n{step}\n```")


main(*sys.argv[1:])

"""compare_table.py DIR [REFERENCE.csv]: prints what scripts/compare-fenics measured, as a Markdown table.

DIR holds, a round each: fenics.ROUND.csv and .json (fenics_listing.py), ricochet.NAME.ROUND.h5 (docs of the results) and
ricochet.NAME.ROUND.memory.RANK (peak_memory.py); NAME is nRANKS, or nRANKS-direct for a factorisation in every iteration. Of several rounds the shortest time and the largest memory count.
"""

import glob
import json
import os
import re
import sys

import h5py
import numpy as np

SERIES = {
    "time": "series/time",
    "acceleration": "series/impactor/acceleration",
    "position": "series/impactor/position",
    "surface displacement": "series/contact/surface_displacement",
}


def read_csv(path):
    """Series of a t,q,u_hit,F,acc file by name."""
    t, q, u_hit, _, acc = np.loadtxt(path, delimiter=",", skiprows=1, unpack=True)
    return {"time": t, "acceleration": acc, "position": q, "surface displacement": u_hit}


def fenics(folder):
    """Series and cost of the FEniCS runs."""
    costs = []
    for path in sorted(glob.glob(f"{folder}/fenics.*.json")):
        with open(path, encoding="utf-8") as file:
            costs.append(json.load(file))
    cost = {
        "unknowns": costs[0]["unknowns"],
        "newton_iterations": costs[0]["newton_iterations"],
        "steps": min(c["wall_time_steps"] for c in costs),
        "total": min(c["wall_time_total"] for c in costs),
        "memory": max(c["peak_memory"] for c in costs),
    }
    return read_csv(f"{folder}/fenics.1.csv"), cost


def ricochet(folder, name):
    """Series and cost of ricochet's runs of a name: nRANKS, or nRANKS-direct."""
    series, runs = None, []
    for path in sorted(glob.glob(f"{folder}/ricochet.{name}.*.h5")):
        parts = glob.glob(path.removesuffix(".h5") + ".memory.*")
        memory = sum(int(open(part, encoding="ascii").read()) for part in parts)
        with h5py.File(path, "r") as file:
            series = {name: file[key][:] for name, key in SERIES.items()}
            runs.append(
                {
                    "newton_iterations": int(file.attrs["newton_iterations"]),
                    "steps": float(file.attrs["wall_time_steps"]),
                    "total": float(file.attrs["wall_time_total"]),
                    "memory": memory,
                }
            )
    cost = {
        "newton_iterations": runs[0]["newton_iterations"],
        "steps": min(run["steps"] for run in runs),
        "total": min(run["total"] for run in runs),
        "memory": max(run["memory"] for run in runs),
    }
    return series, cost


def difference(name, series, yardstick):
    """Largest difference over the yardstick's maximum."""
    ours, theirs = series[name], yardstick[name]
    if ours.shape != theirs.shape or not np.allclose(series["time"], yardstick["time"], rtol=1e-12, atol=1e-15):
        sys.exit(f"compare_table: the two series have other times: {ours.shape} and {theirs.shape} rows")
    return np.abs(ours - theirs).max() / np.abs(theirs).max()


def table(columns, yardstick, yardstick_name):
    """Lines of the table; columns: (title, series, cost), the first one FEniCS."""
    own = columns[0][2]
    titles = [title for title, _, _ in columns]
    rows = [["", *titles], ["---"] * (len(titles) + 1)]
    for name in list(SERIES)[1:]:
        cells = ["" if s is yardstick else f"{difference(name, s, yardstick):.1e}" for _, s, _ in columns]
        rows.append([f"{name}: max difference to {yardstick_name}, over its max", *cells])
    rows.append(["Newton iterations", *(str(c["newton_iterations"]) for _, _, c in columns)])
    each = [c["steps"] / c["newton_iterations"] for _, _, c in columns]
    rows.append(["time per Newton iteration (s)", *(f"{seconds:.4f}" for seconds in each)])
    rows.append(["FEniCS / this", *(f"{each[0] / seconds:.2f}" for seconds in each)])
    rows.append(["total time (s)", *(f"{c['total']:.2f}" for _, _, c in columns)])
    rows.append(["FEniCS / this", *(f"{own['total'] / c['total']:.2f}" for _, _, c in columns)])
    rows.append(["peak memory, all ranks (MB)", *(f"{c['memory'] / 1e6:.0f}" for _, _, c in columns)])
    rows.append(["FEniCS / this", *(f"{own['memory'] / c['memory']:.2f}" for _, _, c in columns)])
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    return ["| " + " | ".join(cell.ljust(w) for cell, w in zip(row, widths)) + " |" for row in rows]


def main():
    folder = sys.argv[1]
    series, cost = fenics(folder)
    columns = [("FEniCS, 1 rank", series, cost)]
    files = (os.path.basename(path) for path in glob.glob(f"{folder}/ricochet.n*.h5"))
    for name in sorted({re.match(r"ricochet\.(n\d+(-direct)?)\.", name)[1] for name in files}):
        ranks = int(re.match(r"n(\d+)", name)[1])
        title = f"ricochet, {ranks} rank" + "s" * (ranks > 1) + ", factorising always" * name.endswith("-direct")
        columns.append((title, *ricochet(folder, name)))
    print(f"{cost['unknowns']} unknowns, {len(series['time']) - 1} steps")
    if len(sys.argv) > 2:
        print("\n".join(table(columns, read_csv(sys.argv[2]), "the reference")))
    else:
        print("\n".join(table(columns, series, "FEniCS")))


if __name__ == "__main__":
    main()

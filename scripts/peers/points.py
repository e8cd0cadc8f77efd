"""Times a peer at its settings and keeps the points: OUTDIR/peers.csv and OUTDIR/series/*.csv."""

import csv
import re
import statistics
import time
import traceback

import numpy as np

HEADER = ["name", "setting", "build", "run", "series"]
ROWS = 20_000  # of a series at most
QUICK = 5.0  # s: what takes less is repeated, and the median is kept
REPEATS = 3


def collect(name, settings, folder, budget):
    """Adds to OUTDIR/peers.csv the settings that it lacks.

    They are pairs of a text and a function that gives the seconds to build and to run, and the series: rows of time (s),
    acceleration (m/s2) and, where the peer has it, largest tension (Pa). None is begun after `budget` seconds.
    """
    (folder / "series").mkdir(parents=True, exist_ok=True)
    table = folder / "peers.csv"
    rows = list(csv.DictReader(table.open(encoding="utf-8"))) if table.exists() else []
    begin = time.perf_counter()
    for setting, measure in settings:
        if any((row["name"], row["setting"]) == (name, setting) for row in rows):
            continue
        if time.perf_counter() - begin > budget:
            print(f"{name}: no time left for {setting}", flush=True)
            continue
        try:
            built, ran, series = measure()
            if not np.isfinite(series).all():
                raise ArithmeticError("the series is not finite")
            columns = ",".join(["time", "acceleration", "tension"][: series.shape[1]])
        except Exception:  # whatever it is, the next setting may do
            print(f"{name}: {setting} failed:\n{traceback.format_exc()}", flush=True)
            continue
        path = f"series/{slug(name)}-{slug(setting)}.csv"
        thin = series[:: -(-len(series) // ROWS)]
        np.savetxt(folder / path, thin, fmt="%.10e", delimiter=",", header=columns, comments="")
        rows.append(dict(zip(HEADER, [name, setting, f"{built:.4g}", f"{ran:.4g}", path], strict=True)))
        with table.open("w", encoding="utf-8", newline="") as file:
            writer = csv.DictWriter(file, HEADER, lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
        peak = series[:, 1].max()
        print(f"{name}: {setting}: {built:.3g} s + {ran:.3g} s, peak {peak:.5g} m/s2", flush=True)


def timed(build):
    """What collect() asks for, by build(): it makes all that comes before the first step and returns run(), which takes the steps.

    run() gives times, accelerations and perhaps tensions. Seconds are medians of a few where they are short.
    """
    built, ran = [], []
    while True:
        start = time.perf_counter()
        run = build()
        middle = time.perf_counter()
        columns = run()
        built.append(middle - start)
        ran.append(time.perf_counter() - middle)
        if built[0] + ran[0] > QUICK or len(built) == REPEATS:
            return statistics.median(built), statistics.median(ran), np.column_stack(columns)


def slug(text):
    """A file's name that tells what `text` does."""
    return re.sub(r"[^a-z0-9.]+", "-", text.lower().replace("×", "x").replace("δ", "d")).strip("-")

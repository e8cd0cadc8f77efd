"""error_table.py OUT FOLDER: what the cases in OUT are off by as FOLDER/errors.csv and as the table of FOLDER/README.md."""

import csv
import json
import sys
from pathlib import Path

from cases import CASES
from markers import replace, table

PARTS = ["cells", "vectors", "step", "springs", "patch", "rows"]


def main(out, folder):
    found = {name: json.loads((out / f"{name}.json").read_text(encoding="utf-8")) for name in CASES if (out / f"{name}.json").exists()}
    with (folder / "errors.csv").open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["case", *PARTS, "error"])
        for name, case in found.items():
            writer.writerow([name, *(f"{case['parts'][part]:.2e}" for part in PARTS), f"{case['error']:.2e}"])
    rows = [
        [name, f"{case['unknowns']:,}", f"{case['peak']:.2f}", f"{1e3 * case['end']:.4f}",
         *(f"{case['parts'][part]:.1e}" for part in PARTS), f"**{case['error']:.1e}**", f"{case['smallest_patch']:.1e}", f"{case['seconds']:.0f} s"]
        for name, case in found.items()
    ]  # fmt: skip
    head = ["case", "unknowns", "peak, m/s²", "end, ms", *PARTS, "sum", "r_p = h/8 to the limit", "CPU time"]
    replace(folder / "README.md", "errors", table(head, rows))


main(Path(sys.argv[1]), Path(sys.argv[2]))

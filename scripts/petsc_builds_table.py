"""petsc_builds_table.py OUT DOC: what scripts/petsc-builds found into OUT as a table of DOC; status 1 where a series is another."""

import os
import re
import sys

import numpy as np
import ricochet
from markers import replace, table

BUILDS = {"debian32": "Debian's petsc-dev", "debian64": "Debian's petsc64-dev", "newest": "PyPI's petsc", "mpich": "PyPI's petsc"}
# Newton's method stops at residuals of 1e-12 of the forces, and a factor is rounded otherwise by each package.
SAME = 1e-9


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def difference(run, other):
    """Largest difference of the acceleration over its peak."""
    a, b = (one.series["impactor/acceleration"] for one in (run, other))
    return np.abs(a - b).max() / a.max() if a.shape == b.shape else np.inf


def main(out, doc):
    rows, same = [], True
    for name, title in BUILDS.items():
        folder = f"{out}/{name}"
        if not os.path.exists(f"{folder}/facts"):
            continue
        mpi, bits, packages = read(f"{folder}/facts").splitlines()
        passed = sum(int(count) for count in re.findall(r"test result: ok\. (\d+) passed", read(f"{folder}/tests")))
        cells = []
        for newton in ["condensed", "full"]:
            for n in [1, 2]:
                run, default = (ricochet.Run(f"{out}/{build}/{newton}-{n}.h5") for build in (name, "debian32"))
                error = difference(default, run)
                same &= error < SAME
                cells.append("–" if name == "debian32" else f"{error:.0e}")
        petsc = run.attributes["petsc_version"]
        rows.append([title, petsc, f"{bits} bits", mpi, packages.replace(" ", ", "), passed, *cells])
    head = ["PETSc", "version", "indices", "MPI", "packages", "petsc-wrap's tests passed"]
    head += [f"{newton}, {n}" for newton in ["condensed", "full"] for n in ["1 rank", "2 ranks"]]
    replace(doc, "builds", table(head, rows))
    if not same:
        raise SystemExit(f"petsc-builds: series differ by more than {SAME} of their peak")


main(*sys.argv[1:])

"""Runs ricochet, and reads its runs and sweeps as numpy arrays in SI units.

    import ricochet

    run = ricochet.run("plate20.toml", set={"impactor.speed": 2.0})
    run.series["impactor/acceleration"].max(), run.contacts["start"]    # m/s2, s
    run.plot()

    sweep = ricochet.Sweep("k.h5")
    sweep.grid("peak_force")    # N
    sweep.plot("peak_force")

docs/python.md has examples; docs/results.md and docs/sweep.md list the names of series, members and contacts with their units.
"""

from .program import RicochetError, run
from .results import CONTACT, Run, Sweep

__all__ = ["CONTACT", "RicochetError", "Run", "Sweep", "run"]
__version__ = "0.1.0"

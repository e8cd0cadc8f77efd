"""A Maxwell chain for a table of moduli: tests/fixtures/laminated/cantilever.csv.

    $(scripts/peers/python) scripts/independent/fit_chain.py tests/fixtures/laminated/cantilever.csv

The table is that of the elastomer on the cantilever of code_aster's case V2.02.151: Re E and the loss factor at some frequencies, linear
between them, with a Poisson's ratio of 0.45. The chain relaxes in shear alone. Its bulk modulus is E/(3 (1 - 2 nu)) at 200 Hz; its shear modulus is
that which with it gives the complex E. The moduli of terms with given times are fitted by least squares of relative errors without negative
ones. Writes lines of time (s) and modulus (Pa), and says bulk modulus, G at rest and how well the chain fits.
"""

import sys
from math import pi

import numpy as np
from scipy.optimize import nnls

# Hz, Pa, loss factor.
TABLE = (
    (1, 23.2e6, 1.1),
    (10, 58e6, 0.85),
    (50, 145e6, 0.7),
    (100, 203e6, 0.6),
    (500, 348e6, 0.4),
    (1000, 435e6, 0.35),
    (1500, 464e6, 0.34),
)
POISSON = 0.45
BULK = 250e6 / (3 * (1 - 2 * POISSON))
TIMES = [10 ** (-6 + 0.5 * i) for i in range(15)]
# The table's two moduli belong to no causal material, and no chain has both. The loss is what damps the beam; of its stiffness the elastomer
# has 3%.
OF_STORAGE = 0.1
# The strip's vibrations, Hz, with their damping ratios. The case takes the table's moduli for them: so has the chain the table's loss at the rates at
# which they decay, with this weight over that of the other frequencies.
VIBRATIONS = ((33.09, 0.01178), (211.36, 0.01814), (601.64, 0.01883))
AT_VIBRATIONS = 10.0


def young(frequency):
    """The complex E of the table."""
    for (f0, e0, loss0), (f1, e1, loss1) in zip(TABLE, TABLE[1:]):
        if frequency <= f1:
            part = (frequency - f0) / (f1 - f0)
            return (e0 + part * (e1 - e0)) * (1 + 1j * (loss0 + part * (loss1 - loss0)))
    raise ValueError(frequency)


def shear(e):
    """G of E and the bulk modulus."""
    return 3 * BULK * e / (9 * BULK - e)


def of_shear(g):
    """E of G and the bulk modulus."""
    return 9 * BULK * g / (3 * BULK + g)


def fit(samples):
    """G at rest and the moduli of the terms."""
    rows, known = [], []
    wanted = [(2j * pi * f, f, (OF_STORAGE, 1.0)) for f in samples]
    wanted += [(2 * pi * f * (1j - damping), f, (0.0, AT_VIBRATIONS)) for f, damping in VIBRATIONS]
    for rate, frequency, weights in wanted:
        goal = shear(young(frequency))
        terms = np.array([1.0] + [rate * time / (1 + rate * time) for time in TIMES])
        for weight, part in zip(weights, (np.real, np.imag)):
            rows.append(weight * part(terms) / goal.imag)
            known.append(weight * part(goal) / goal.imag)
    return nnls(np.array(rows), np.array(known))[0]


def main():
    samples = [1500 ** (i / 80) for i in range(81)]
    equilibrium, *moduli = fit(samples)
    chain = [(time, modulus) for time, modulus in zip(TIMES, moduli) if modulus > 0]

    def fitted(frequency):
        rates = ((2j * pi * frequency * time, modulus) for time, modulus in chain)
        return of_shear(equilibrium + sum(modulus * w / (1 + w) for w, modulus in rates))

    with open(sys.argv[1], "w") as out:
        print("time,modulus", file=out)
        for time, modulus in chain:
            print(f"{time:.6e},{modulus:.6e}", file=out)
    print(f"bulk = {BULK:.6e}, shear = {equilibrium:.6e}, {len(chain)} terms")
    worst = 0.0
    for frequency in samples + [f for f, _, _ in TABLE] + [f for f, _ in VIBRATIONS]:
        error = abs(fitted(frequency) / young(frequency) - 1)
        worst = max(worst, error)
        if frequency not in samples[1:]:
            e, goal = fitted(frequency), young(frequency)
            print(
                f"{frequency:8.2f} Hz: E {e.real / goal.real - 1:+.1%}, loss factor"
                f" {e.imag / e.real / (goal.imag / goal.real) - 1:+.1%}, their product {e.imag / goal.imag - 1:+.1%}"
            )
    print(f"largest error of E from 1 to 1500 Hz: {worst:.1%}")


main()

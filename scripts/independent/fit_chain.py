"""A Maxwell chain for a table of moduli: tests/fixtures/laminated/cantilever.csv.

    python3 scripts/independent/fit_chain.py tests/fixtures/laminated/cantilever.csv

The table is that of the elastomer on the cantilever of code_aster's case V2.02.151: Re E and the loss factor at some frequencies, linear
between them, with a Poisson's ratio of 0.45. The chain relaxes in shear alone. Its bulk modulus is E/(3 (1 - 2 nu)) at 200 Hz; its shear modulus is
that which with it gives the complex E. The moduli of terms with given times are fitted by least squares of relative errors without negative
ones, by cyclic descent. Writes lines of time (s) and modulus (Pa), and says bulk modulus, G at rest and how well the chain fits.
"""

import cmath
import sys
from math import log, pi

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
    weights = ((OF_STORAGE, lambda z: complex(z).real), (1.0, lambda z: complex(z).imag))
    for frequency in samples:
        goal = shear(young(frequency))
        terms = [1.0] + [1j * w / (1 + 1j * w) for w in (2 * pi * frequency * time for time in TIMES)]
        for weight, part in weights:
            rows.append([weight * part(term) / abs(goal.imag) for term in terms])
            known.append(weight * part(goal) / abs(goal.imag))
    count = len(rows[0])
    normal = [[sum(row[i] * row[j] for row in rows) for j in range(count)] for i in range(count)]
    right = [sum(row[i] * value for row, value in zip(rows, known)) for i in range(count)]
    x = [0.0] * count
    for _ in range(200000):
        change = 0.0
        for i in range(count):
            new = max(0.0, x[i] + (right[i] - sum(a * b for a, b in zip(normal[i], x))) / normal[i][i])
            change = max(change, abs(new - x[i]))
            x[i] = new
        if change < 1e-7 * max(x):
            break
    return x


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
    for frequency in samples + [f for f, _, _ in TABLE] + [33.09, 211.36, 601.64]:
        error = abs(fitted(frequency) / young(frequency) - 1)
        worst = max(worst, error)
        if frequency not in samples[1:]:
            e, goal = fitted(frequency), young(frequency)
            print(
                f"{frequency:8.2f} Hz: E {e.real / goal.real - 1:+.1%}, loss factor"
                f" {e.imag / e.real / (goal.imag / goal.real) - 1:+.1%}"
            )
    print(f"largest error of E from 1 to 1500 Hz: {worst:.1%}")


main()

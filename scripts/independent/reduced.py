"""Load-dependent Ritz vectors (Wilson, Yuan and Dickens, 1982) for the loads of all radii at once."""

import math
from dataclasses import dataclass

import numpy as np
import scipy.linalg as dense

FREQUENCY = 1000.0  # Hz: shift of the vectors, which also holds the rigid-body modes of a free plate


@dataclass(frozen=True)
class Reduced:
    """K and the loads on M-orthonormal vectors: the first `many` of the first load, then `few` of each other load."""

    stiffness: np.ndarray
    loads: np.ndarray
    many: int
    few: int

    @classmethod
    def on_vectors(cls, quarter, many, few):
        """Vectors (K + s M)^-1 a, (K + s M)^-1 M (K + s M)^-1 a, …: `many` for the first column of the loads, `few` for the others.

        Patches of different radii move the plate alike but for what is close to them, which answers as if at rest: few do.
        """
        factor = quarter.factor((2 * math.pi * FREQUENCY) ** 2)
        counts = [many, *[few] * (quarter.loads.shape[1] - 1)]
        basis = np.empty((len(quarter.loads), sum(counts)), order="F")
        number = 0
        for load, count in zip(quarter.loads.T, counts, strict=True):
            right = load
            for _ in range(count):
                vector, earlier = factor(right), basis[:, :number]
                weighted = quarter.mass @ vector
                for _ in range(2):  # twice is enough
                    vector -= earlier @ (earlier.T @ weighted)
                    weighted = quarter.mass @ vector
                norm = math.sqrt(vector @ weighted)
                basis[:, number] = vector / norm
                right = weighted / norm
                number += 1
        return cls(basis.T @ (quarter.stiffness @ basis), basis.T @ quarter.loads, many, few)

    def half(self):
        """The same on half of the vectors of each load."""
        starts = [0, *(self.many + self.few * number for number in range(self.loads.shape[1] - 1))]
        counts = [self.many // 2, *[self.few // 2] * (self.loads.shape[1] - 1)]
        kept = np.concatenate([start + np.arange(count) for start, count in zip(starts, counts, strict=True)])
        return Reduced(self.stiffness[np.ix_(kept, kept)], self.loads[kept], self.many // 2, self.few // 2)

    def modes(self, number):
        """omega^2 (1/s2) and phi (kg^-0.5) for the load of this number."""
        squares, vectors = dense.eigh(self.stiffness)
        return squares, vectors.T @ self.loads[:, number]

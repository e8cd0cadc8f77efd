"""Independent theory for validation_table.py: closed forms, differential equations and series, by code that shares nothing with the program."""

import math

import numpy as np


def top(times, values):
    """Time and value of the top of a parabola through the largest value and its neighbours."""
    at = int(np.clip(np.argmax(values), 1, len(values) - 2))
    middle = times[at]
    a, b, c = np.polyfit(times[at - 1 : at + 2] - middle, values[at - 1 : at + 2], 2)
    return middle - b / (2 * a), c - b * b / (4 * a)


def bending_stiffness(young, poisson, thickness):
    return young * thickness**3 / (12 * (1 - poisson**2))


def hertz_impact(stiffness, mass, speed):
    """Largest force and duration of a mass on F = k α^{3/2}, from ½ m v² = ⅖ k α^{5/2}."""
    depth = (5 * mass * speed**2 / (4 * stiffness)) ** 0.4
    duration = 0.8 * math.sqrt(math.pi) * math.gamma(0.4) / math.gamma(0.9) * depth / speed
    return stiffness * depth**1.5, duration


def zener_equation(parameter, step=5e-4):
    """Restitution, largest force and duration of σ″ + (1 + λ d/dτ)⟨σ⟩^{3/2} = 0, σ(0) = 0, σ′(0) = 1, by the classical Runge–Kutta method."""

    def rates(s, w):
        force = max(s, 0.0) ** 1.5
        return w - parameter * force, -force

    s, w, steps, forces = 0.0, 1.0, 0, [0.0]
    while True:
        a = rates(s, w)
        b = rates(s + step / 2 * a[0], w + step / 2 * a[1])
        c = rates(s + step / 2 * b[0], w + step / 2 * b[1])
        d = rates(s + step * c[0], w + step * c[1])
        before = s, w
        s += step / 6 * (a[0] + 2 * b[0] + 2 * c[0] + d[0])
        w += step / 6 * (a[1] + 2 * b[1] + 2 * c[1] + d[1])
        steps += 1
        forces.append(max(s, 0.0) ** 1.5)
        if s <= 0.0:
            # The force is as good as zero there, so σ is a straight line.
            end = (steps - 1 + before[0] / (before[0] - s)) * step
            return -w, top(step * np.arange(steps + 1), np.array(forces))[1], end


def ball_on_modes(frequencies, shapes, stiffness, mass, speed, end, step):
    """Contacts (start, end, peak, its time) and last velocity of a ball on F = k ⟨α⟩^{3/2} that hits modes of unit modal mass, whose values
    at the point of impact are `shapes`.

    Each mode moves as its cosine and sine, and as the force drives it, which is a straight line over a step.
    """
    angle = frequencies * step
    cosine, sine = np.cos(angle), np.sin(angle)
    # A mode's displacement and velocity at the end of a step by the force at its beginning and its end.
    first = shapes * (sine / angle - cosine) / frequencies**2
    last = shapes * (1 - sine / angle) / frequencies**2
    first_rate = shapes * (sine - (1 - cosine) / angle) / frequencies
    last_rate = shapes * (1 - cosine) / (angle * frequencies)
    flexibility = step**2 / (6 * mass) + shapes @ last
    over, times = sine / frequencies, sine * frequencies
    x, v = np.zeros_like(frequencies), np.zeros_like(frequencies)
    position, velocity, force = 0.0, speed, 0.0
    clock, forces, depths = [0.0], [0.0], [0.0]
    for count in range(1, round(end / step) + 1):
        x, v = cosine * x + over * v + first * force, cosine * v - times * x + first_rate * force
        position += step * velocity - step**2 / (3 * mass) * force
        velocity -= step / (2 * mass) * force
        free = position - shapes @ x
        new = 0.0
        if free > 0.0:
            # α + G k α^{3/2} = free, by Newton's method from above.
            alpha = free
            for _ in range(50):
                change = (alpha + flexibility * stiffness * alpha**1.5 - free) / (1 + 1.5 * flexibility * stiffness * math.sqrt(alpha))
                alpha -= change
                if abs(change) < 1e-15 * free:
                    break
            new = stiffness * alpha**1.5
        x, v = x + last * new, v + last_rate * new
        position -= step**2 / (6 * mass) * new
        velocity -= step / (2 * mass) * new
        force = new
        clock.append(count * step)
        forces.append(force)
        depths.append(position - shapes @ x)
    return contacts(np.array(clock), np.array(forces), np.array(depths)), velocity


def contacts(times, forces, depths):
    """Of a series: from zero to zero of the indentation."""
    found, begin = [], None
    for i, force in enumerate(forces):
        if begin is None and force > 0.0:
            begin = i
        elif begin is not None and force == 0.0:
            zero = [times[j] - depths[j] * (times[j] - times[j - 1]) / (depths[j] - depths[j - 1]) for j in (begin, i)]
            when, peak = top(times[begin - 1 : i + 1], forces[begin - 1 : i + 1])
            found.append({"start": zero[0], "end": zero[1], "peak_force": peak, "peak_time": when})
            begin = None
    return found


def free_plate_by_ritz(edge, poisson, stiffness, surface_mass, degree=16):
    """Frequencies of the free square plate: Ritz's method with products of Legendre polynomials, without the three rigid motions."""
    x, weight = np.polynomial.legendre.leggauss(degree + 2)
    legendre = np.polynomial.legendre
    units = np.eye(degree + 1)
    scale = np.sqrt(np.arange(degree + 1) + 0.5)[:, None]
    values = [scale * np.array([legendre.legval(x, legendre.legder(unit, order)) for unit in units]) for order in (0, 1, 2)]

    def integral(i, j):
        return values[i] * weight @ values[j].T

    mixed = integral(0, 2)
    energy = np.kron(integral(2, 2), integral(0, 0)) + np.kron(integral(0, 0), integral(2, 2))
    energy += poisson * (np.kron(mixed, mixed.T) + np.kron(mixed.T, mixed)) + 2 * (1 - poisson) * np.kron(integral(1, 1), integral(1, 1))
    return np.sqrt(np.linalg.eigvalsh(energy)[3:] * stiffness / surface_mass) / (edge / 2) ** 2 / (2 * math.pi)


def different(values):
    """Frequencies without the second of each equal pair."""
    return [f for i, f in enumerate(values) if not i or f > values[i - 1] * (1 + 1e-6)]


def spectrum_peaks(times, values, highest):
    """Frequencies and amplitudes of the peaks of a series, up to a frequency: Gaussian window, eightfold zero padding, and a parabola through
    the logarithms."""
    step, count = times[1] - times[0], len(times)
    place = np.linspace(-1, 1, count)
    window = np.exp(-0.5 * (place / 0.22) ** 2)
    # A free plate also drifts.
    values = values - np.polyval(np.polyfit(place, values, 1), place)
    padded = 8 * count
    size = np.abs(np.fft.rfft(values * window, padded)) / window.sum() * 2
    first, last = int(0.5 * step * padded), int(highest * step * padded)
    found = []
    for i in range(first, last):
        if size[i - 1] < size[i] > size[i + 1] and size[i] > 1e-3 * size[first:last].max():
            a, b, c = np.log(size[i - 1 : i + 2])
            found.append(((i + 0.5 * (a - c) / (a - 2 * b + c)) / (padded * step), size[i]))
    return found


class Spline:
    """A natural cubic spline."""

    def __init__(self, x, y):
        self.x, self.y = x, y
        width, count = np.diff(x), len(x)
        slopes = np.diff(y) / width
        # The curvatures, by elimination.
        ratios, self.curvatures = np.zeros(count), np.zeros(count)
        for i in range(1, count - 1):
            diagonal = 2 * (width[i - 1] + width[i]) - width[i - 1] * ratios[i - 1]
            ratios[i] = width[i] / diagonal
            self.curvatures[i] = (6 * (slopes[i] - slopes[i - 1]) - width[i - 1] * self.curvatures[i - 1]) / diagonal
        for i in range(count - 2, 0, -1):
            self.curvatures[i] -= ratios[i] * self.curvatures[i + 1]

    def __call__(self, at):
        i = np.clip(np.searchsorted(self.x, at), 1, len(self.x) - 1)
        width = self.x[i] - self.x[i - 1]
        after = (at - self.x[i - 1]) / width
        before = 1 - after
        bent = (before**3 - before) * self.curvatures[i - 1] + (after**3 - after) * self.curvatures[i]
        return before * self.y[i - 1] + after * self.y[i] + width**2 / 6 * bent

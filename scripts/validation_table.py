"""validation_table.py OUT DOC: runs scenes into OUT with target/release/ricochet, and writes the table of DOC beside what theory says of them."""

import csv
import json
import math
import os
import re
import subprocess
import sys

import h5py
import numpy as np

from markers import replace, table
from validation_theory import ball_on_modes, bending_stiffness, contacts, different, free_plate_by_ritz, hertz_impact, spectrum_peaks, Spline, top, zener_equation

REPOSITORY = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PROGRAM = f"{REPOSITORY}/target/release/ricochet"
FIXTURES = f"{REPOSITORY}/tests/fixtures"
OUT = sys.argv[1]


class Run:
    """A scene's result."""

    def __init__(self, name, *sections):
        scene, result = f"{OUT}/{name}.toml", f"{OUT}/{name}.h5"
        with open(scene, "w", encoding="utf-8") as file:
            file.write("\n".join(sections) + "\n")
        done = subprocess.run([PROGRAM, "run", scene, "-o", result, "--force"], capture_output=True, text=True, check=False)
        if done.returncode:
            sys.exit(f"{scene}: status {done.returncode}\n{done.stderr}")
        with h5py.File(result, "r") as file:
            self.time = file["series/time"][:]
            self.acceleration = file["series/impactor/acceleration"][:]
            self.velocity = file["series/impactor/velocity"][:]
            self.force = file["series/contact/force"][:]
            self.deflection = file["series/contact/surface_displacement"][:]
            self.contacts = [dict(zip(CONTACT, row)) for row in zip(*(file[f"contacts/{key}"][:] for key in CONTACT))]
            self.probes = {key: value["displacement"][:] for key, value in file.get("series/probe", {}).items()}
            self.model = file.attrs["model"].decode()

    def peak(self):
        """Of the force: the top of a parabola through the highest step and its neighbours."""
        return top(self.time, self.force)[1]


CONTACT = ["start", "end", "peak_force", "peak_time"]


def section(name, **values):
    """A table of a scene."""

    def toml(value):
        if isinstance(value, (list, tuple)):
            return "[" + ", ".join(toml(one) for one in value) + "]"
        if isinstance(value, dict):
            return "{ " + ", ".join(f"{key} = {toml(one)}" for key, one in value.items()) + " }"
        return json.dumps(value) if isinstance(value, (str, bool, int)) else repr(float(value))

    return "\n".join([name, *(f"{key} = {toml(value)}" for key, value in values.items())])


def body(young, poisson, density, size, **more):
    """The table of a box."""
    return section("[body]", young=young, poisson=poisson, density=density, size=size, **more)


def time(end, tolerance=1e-2, **more):
    """The tables of time and accuracy."""
    return section("[time]", end=end, **more) + "\n" + section("[accuracy]", tolerance=tolerance)


def simple_support(*surfaces):
    """Sides that do not move across the plate."""
    return "\n".join(section("[[support]]", surface=name, kind="clamped", components=["z"]) for name in surfaces)


# Rows of the table.


def number(value, unit="", digits=5):
    text = f"{value:#.{digits}g}".rstrip(".")
    return f"{text} {unit}".strip()


def ratio(value, style=".1e"):
    """1e-7 and not 1e-07."""
    return re.sub(r"e([+-])0(\d)", r"e\1\2", format(value, style))


def row(what, source, expected, ours, unit="", scale=1.0, digits=5):
    """One number against another; a negative difference where ours is smaller."""
    return [what, source, number(expected * scale, unit, digits), number(ours * scale, unit, digits), ratio(ours / expected - 1, "+.1e")]


# Hertz.


def hertz():
    rows = []
    # Two equal spheres: the relative motion of one of half the mass and half the radius.
    radius, young, poisson, density, speed = 0.01, 48e9, 0.20, 2800.0, 20.0
    mass = density * 4 / 3 * math.pi * radius**3 / 2
    stiffness = 4 / 3 * math.sqrt(radius / 2) * young / (2 * (1 - poisson**2))
    ran = Run(
        "spheres",
        body(young, poisson, density, [1.0, 1.0, 1.0], model="half-space"),
        section("[impactor]", mass=mass, radius=radius / 2, young=young, poisson=poisson, speed=speed),
        time(1e-4, 1e-6),
    )
    force, duration = hertz_impact(stiffness, mass, speed)
    what, source = "Two glass spheres, R = 10 mm, ±10 m/s: ", "Hertz, closed form; data of test 1 of Chung & Ooi 2011"
    rows.append(row(what + "peak force", source, force, ran.peak(), "kN", 1e-3))
    rows.append(row(what + "duration", source, duration, ran.contacts[0]["end"], "µs", 1e6))

    radius, young, poisson, density, speed = 0.1, 70e9, 0.30, 2699.0, 0.2
    mass = density * 4 / 3 * math.pi * radius**3
    stiffness = 4 / 3 * math.sqrt(radius) * young / (1 - poisson**2)
    ran = Run(
        "rigid-plane",
        body(young, poisson, density, [1.0, 1.0, 1.0], model="half-space"),
        section("[impactor]", mass=mass, radius=radius, stiffness=stiffness, speed=speed),
        time(2e-3, 1e-6),
    )
    force, duration = hertz_impact(stiffness, mass, speed)
    what, source = "Aluminium sphere on a rigid plane, R = 0.1 m, 0.2 m/s: ", "the same, test 2"
    rows.append(row(what + "peak force", source, force, ran.peak(), "kN", 1e-3))
    rows.append(row(what + "duration", source, duration, ran.contacts[0]["end"], "µs", 1e6))
    return rows


# Zener.


def zener():
    rows = []
    young, poisson, density, thickness, mass, speed = 70e9, 0.23, 2500.0, 0.1, 2.0, 3.0
    impedance = 8 * math.sqrt(density * thickness * bending_stiffness(young, poisson, thickness))
    for parameter in [0.05, 0.1, 0.2, 0.3, 0.5, 1.0, 1.5, 2.0]:
        stiffness = (parameter * impedance / (speed**0.2 * mass**0.6)) ** 2.5
        unit = (mass**2 / (stiffness**2 * speed)) ** 0.2
        expected = zener_equation(parameter)
        ran = Run(
            f"zener-{parameter}",
            body(young, poisson, density, [1.0, 1.0, thickness], model="infinite-plate"),
            section("[impactor]", mass=mass, radius=0.05, stiffness=stiffness, speed=speed),
            time(expected[2] * 1.1 * unit, 1e-6),
        )
        ours = -ran.velocity[-1] / speed, ran.peak() * unit / (mass * speed), ran.contacts[0]["end"] / unit
        difference = max(abs(a - b) for a, b in zip(ours, expected))
        text = [", ".join(f"{value:.5f}" for value in values) for values in (expected, ours)]
        source = "Zener 1941, his equation by Runge–Kutta" if not rows else "the same"
        what = f"Infinite plate, λ = {parameter}: restitution, peak force, duration"
        rows.append([what, source, *text, ratio(difference)])
    return rows


# Contact laws.


def laws():
    rows = []
    mass, speed, stiffness = 50.0, 4.0, 5e4
    plate = body(70e9, 0.23, 2500.0, [1.0, 1.0, 0.02], model="half-space")
    ran = Run(
        "spring",
        plate,
        section("[impactor]", mass=mass, speed=speed),
        section("[contact]", law="power", stiffness=stiffness, exponent=1.0),
        time(0.15, 1e-6),
    )
    what, source = "Mass of 50 kg on a spring law of 50 kN/m, 4 m/s: ", "closed form, "
    rows.append(row(what + "peak force", source + "v √(km)", speed * math.sqrt(stiffness * mass), ran.peak(), "kN", 1e-3))
    duration = math.pi * math.sqrt(mass / stiffness)
    rows.append(row(what + "duration", source + "π √(m/k)", duration, ran.contacts[0]["end"], "ms", 1e3))
    for damping in [0.01, 0.1, 1.0]:
        low, high = 0.0, min(speed, 1 / damping)
        for _ in range(200):
            v = (low + high) / 2
            too_slow = damping * (speed + v) > math.log((1 + damping * speed) / (1 - damping * v))
            low, high = (v, high) if too_slow else (low, v)
        ran = Run(
            f"damped-{damping}",
            plate,
            section("[impactor]", mass=mass, speed=speed),
            section("[contact]", law="power", stiffness=1e5, exponent=1.3, damping=damping),
            time(0.2, 1e-6),
        )
        source = "Hunt & Crossley 1975, d(v + v′) = ln((1 + dv)/(1 − dv′))" if damping == 0.01 else "the same"
        rows.append(row(f"Damped law F = k α^1.3, dv = {damping * speed:.2g}: restitution", source, low / speed, -ran.velocity[-1] / speed))
    return rows


# A ball on a plate or beam: a sum of modes.


def karas():
    young, poisson, density, edge, thickness, radius, speed = 206e9, 0.3, 7833.0, 0.2, 0.008, 0.01, 1.0
    mass = density * 4 / 3 * math.pi * radius**3
    stiffness = 4 / 3 * math.sqrt(radius) * young / (2 * (1 - poisson**2))
    # A force in the middle moves the odd modes only.
    odd = np.arange(1, 302, 2)
    m, n = (grid.ravel() for grid in np.meshgrid(odd, odd))
    frequencies = (math.pi / edge) ** 2 * (m**2 + n**2) * math.sqrt(bending_stiffness(young, poisson, thickness) / (density * thickness))
    shapes = np.full(len(m), 2 / math.sqrt(density * thickness * edge**2))
    [expected], velocity = ball_on_modes(frequencies, shapes, stiffness, mass, speed, 8e-5, 4e-8)
    ran = Run(
        "karas",
        body(young, poisson, density, [edge, edge, thickness], model="kirchhoff"),
        simple_support("side"),
        section("[impactor]", mass=mass, radius=radius, young=young, poisson=poisson, speed=speed),
        time(8e-5, 1e-5),
    )
    what, source = "Karas' plate, steel ball of 10 mm on 200 × 200 × 8 mm, 1 m/s: ", "Karas 1939, series of 151² modes"
    ours = ran.contacts[0]
    return [
        row(what + "peak force", source, expected["peak_force"], ran.peak(), "N"),
        row(what + "its time", "the same", expected["peak_time"], top(ran.time, ran.force)[0], "µs", 1e6),
        row(what + "end of contact", "the same", expected["end"], ours["end"], "µs", 1e6),
        row(what + "restitution", "the same", -velocity / speed, -ran.velocity[-1] / speed),
    ]


def timoshenko():
    rows = []
    young, density, side, speed = 215.8e9, 7960.0, 0.01, 0.01
    for title, length, radius, end, step in [("short", 0.1535, 0.01, 2e-4, 2e-8), ("long", 0.307, 0.02, 1.9e-3, 1e-7)]:
        mass = density * 4 / 3 * math.pi * radius**3
        stiffness = 4 / 3 * math.sqrt(radius) * young / (2 * (1 - 0.3**2))
        n = np.arange(1, 400, 2)
        frequencies = (n * math.pi / length) ** 2 * math.sqrt(young * side**2 / 12 / density)
        shapes = np.full(len(n), math.sqrt(2 / (density * side**2 * length)))
        expected, _ = ball_on_modes(frequencies, shapes, stiffness, mass, speed, end, step)
        ran = Run(
            f"timoshenko-{title}",
            body(young, 0.0, density, [length, side, side], model="kirchhoff"),
            simple_support("x-min", "x-max"),
            section("[impactor]", mass=mass, radius=radius, stiffness=stiffness, speed=speed),
            time(end, 1e-4),
        )
        if len(ran.contacts) != len(expected):
            sys.exit(f"Timoshenko's {title} beam: {len(ran.contacts)} contacts, and {len(expected)} by the series")
        what = f"Timoshenko's {title} beam, {length * 100:g} cm, ball of {radius * 100:g} cm: "
        for which, (a, b) in enumerate(zip(expected, ran.contacts)):
            source = "the same" if rows else "Timoshenko 1913, series of 200 modes"
            hit = f"hit {which + 1}, " if len(expected) > 1 else ""
            inside = (ran.time >= b["start"]) & (ran.time <= b["end"])
            peak = top(ran.time[inside], ran.force[inside])[1]
            rows.append(row(f"{what}{hit}peak force", source, a["peak_force"], peak, "N"))
            if which:
                rows.append(row(f"{what}{hit}start", source, a["start"], b["start"], "µs", 1e6))
            rows.append(row(f"{what}{hit}end", "the same", a["end"], b["end"], "µs", 1e6))
    return rows


# NAFEMS' square plate.

EDGE, THICKNESS, YOUNG, POISSON, DENSITY = 10.0, 0.05, 200e9, 0.3, 8000.0
STIFFNESS = bending_stiffness(YOUNG, POISSON, THICKNESS)
SURFACE_MASS = DENSITY * THICKNESS
# The basis holds what a contact of a quarter of a second excites.
PLATE = body(YOUNG, POISSON, DENSITY, [EDGE, EDGE, THICKNESS], model="kirchhoff", reduction=120)
SPRING = section("[contact]", law="power", stiffness=160.0, exponent=1.0)


def frequencies(name, highest, *supports):
    """Frequencies of a plate that is hit off its centre, read at two probes; and what the reading may be off by: the same reading of cosines
    of known frequencies, and what the probes differ by."""
    probes = [{"name": "one", "point": [4.1, 2.7, -0.025]}, {"name": "two", "point": [-1.3, 3.6, -0.025]}]
    ran = Run(
        name,
        PLATE,
        *supports,
        section("[impactor]", mass=1.0, speed=0.1, point=[4.1, 2.7, 0.025]),
        SPRING,
        time(100.0, 1e-4, step=2e-3),
        section("[output]", probes=probes),
    )
    # Equal steps: one ends with the contact, and the last with the run.
    free = np.flatnonzero(ran.time > ran.contacts[-1]["end"])[1:-1]
    times = ran.time[free]
    if np.ptp(np.diff(times)) > 1e-9:
        sys.exit(f"{name}: steps of other lengths")
    lists, error = [], 0.0
    for probe in ran.probes.values():
        peaks = spectrum_peaks(times, probe[free, 2], highest)
        cosines = sum(size * np.cos(2 * math.pi * f * times + 0.3 * i) for i, (f, size) in enumerate(peaks))
        again = spectrum_peaks(times, cosines, highest)
        error = max(error, *(abs(a[0] / b[0] - 1) for a, b in zip(again, peaks, strict=True)))
        lists.append([f for f, _ in peaks])
    one, two = lists
    if len(one) != len(two):
        sys.exit(f"{name}: the probes have other peaks, {one} and {two}")
    return one, max(error, *(abs(a / b - 1) for a, b in zip(one, two)))


def plate_frequencies():
    """Rows, and what the reading is off by."""
    rows = []
    free, free_error = frequencies("free-plate", 7.5)
    given, ritz = [1.622, 2.360, 2.922, 4.233, 7.416], different(free_plate_by_ritz(EDGE, POISSON, STIFFNESS, SURFACE_MASS)[:7])
    for i, (source, expected, digits) in enumerate([("NAFEMS FV12", given, 4), ("Kirchhoff's plate by Ritz's method", ritz, 6)]):
        for mode, (a, b) in enumerate(zip(expected, free, strict=True)):
            pair = " (a pair)" if mode > 2 else ""
            rows.append(row(f"Free plate 10 × 10 × 0.05 m: frequency {mode + 1}{pair}", source if not mode else "the same", a, b, "Hz", digits=digits))
    held, held_error = frequencies("held-plate", 9.8, simple_support("side"))
    unit = math.pi / (2 * EDGE**2) * math.sqrt(STIFFNESS / SURFACE_MASS)
    series = [(m * m + n * n) * unit for m, n in ((1, 1), (1, 2), (2, 2))]
    sources = ("NAFEMS", [2.377, 5.942, 9.507], 4), ("closed form, (m² + n²) π √(D/ρh)/2a²", series, 6)
    for source, expected, digits in sources:
        for mode, (a, b) in enumerate(zip(expected, held, strict=True)):
            pair = " (a pair)" if mode == 1 else ""
            what = f"Simply supported plate, the same: frequency {mode + 1}{pair}"
            rows.append(row(what, source if not mode else "the same", a, b, "Hz", digits=digits))
    return rows, max(free_error, held_error)


PRESSURE = 100.0


def suddenly_loaded(name, ratios):
    """Largest deflection of the middle by the series, where `ratios` gives damping ratios from circular frequencies."""
    odd = np.arange(1, 60, 2)
    m, n = (grid.ravel() for grid in np.meshgrid(odd, odd))
    omega = (math.pi / EDGE) ** 2 * (m**2 + n**2) * math.sqrt(STIFFNESS / SURFACE_MASS)
    sign = np.where((m // 2 + n // 2) % 2 == 0, 1.0, -1.0)
    static = sign * 16 * PRESSURE / (math.pi**2 * m * n * SURFACE_MASS * omega**2)
    part = ratios(omega)
    swing = omega * np.sqrt(1 - part**2)
    times = np.arange(0.19, 0.23, 1e-4)
    moved = [static @ (1 - np.exp(-part * omega * t) * (np.cos(swing * t) + part * omega / swing * np.sin(swing * t))) for t in times]
    return top(times, np.array(moved))[1], static.sum()


def loaded_plate():
    first = 2 * (math.pi / EDGE) ** 2 * math.sqrt(STIFFNESS / SURFACE_MASS)
    damping = 2 * 0.02 * first * SURFACE_MASS
    damper = section("[[support]]", surface="bottom", kind="elastic", stiffness=0.0, damping=[0.0, 0.0, damping])
    load = section("[[load.traction]]", surface="top", value=[0.0, 0.0, -PRESSURE])
    # It does not come near the plate.
    impactor = section("[impactor]", mass=1.0, speed=1e-3, gap=1.0)
    runs = [
        Run(name, PLATE, simple_support("side"), *more, load, impactor, SPRING, time(0.4, 1e-5, step=2e-4, **start))
        for name, more, start in (("loaded", [], {}), ("loaded-damped", [damper], {}), ("loaded-at-rest", [], {"initial": "equilibrium"}))
    ]
    if any(ran.contacts for ran in runs):
        sys.exit("the impactor has hit the loaded plate")
    undamped, damped = (top(ran.time, ran.deflection)[1] for ran in runs[:2])
    series, static = suddenly_loaded("series", lambda omega: 0 * omega)
    rows = [row("Simply supported plate under 100 N/m²: static deflection", "Navier's series, 30² modes", static, runs[2].deflection[0], "mm", 1e3)]
    what = "The same, suddenly loaded (NAFEMS 13T): "
    rows.append(row(what + "largest deflection, undamped", "series of 30² modes", series, undamped, "mm", 1e3))
    by_damper, _ = suddenly_loaded("series", lambda omega: 0.02 * first / omega)
    rows.append(row(what + "2% in the first mode, by a damper on the face", "series of 30² modes with this damping", by_damper, damped, "mm", 1e3))
    in_all, _ = suddenly_loaded("series", lambda omega: 0.02 + 0 * omega)
    rows.append(row(what + "2% in every mode; ricochet with the same damper on the face", "series of 30² modes with this damping", in_all, damped, "mm", 1e3))
    return rows


# Equilibrium.


def equilibrium():
    young, density, thickness, gravity, stiffness = 70e9, 2500.0, 0.02, 9.80665, 1e6
    weight = density * gravity * thickness
    kinds = (
        ("springs", "ρgh/k", 0.0, {"model": "mindlin"}, {"kind": "elastic"}, {}),
        # Without Poisson's effect: by it the pressure of its weight, which falls with the height, bends a solid.
        ("pads", "ρgh/k + ρgh²/2E", weight * thickness / (2 * young), {"model": "solid", "cells": [4, 5, 1]}, {"kind": "pad", "normal": [0.0, 0.0, -1.0]}, {"scheme": "newmark"}),
    )  # fmt: skip
    rows = []
    for name, formula, squeeze, theory, kind, scheme in kinds:
        ran = Run(
            f"sinks-on-{name}",
            body(young, 0.0, density, [0.8, 1.0, thickness], **theory),
            section("[[support]]", surface="bottom", stiffness=[0.0, 0.0, stiffness], **kind),
            section("[load]", gravity=[0.0, 0.0, -gravity]),
            section("[impactor]", mass=2.0, radius=0.05, young=210e9, poisson=0.3, speed=1.0, gap=0.5),
            time(1e-3, 1e-4, initial="equilibrium", step=1e-4, **scheme),
        )
        what = f"Pane of 20 mm at rest on {name} of 1e6 N/m³: deflection"
        rows.append(row(what, f"closed form, {formula}", weight / stiffness + squeeze, ran.deflection[0], "mm", 1e3, 6))
    return rows


# Other programs.

GLASS = {"young": 70e9, "poisson": 0.23, "density": 2500.0}
STEEL = {"mass": 52.0, "radius": 0.05, "young": 210e9, "poisson": 0.3, "speed": 1.0}


def columns(path):
    with open(path, encoding="ascii") as file:
        return np.array([[float(field) for field in line] for line in list(csv.reader(file))[1:]]).T


def fenics():
    rows = []
    for case in sorted(os.listdir(f"{FIXTURES}/reference")):
        folder = f"{FIXTURES}/reference/{case}"
        if not os.path.isdir(folder):
            continue
        with open(f"{folder}/case.json", encoding="utf-8") as file:
            data = json.load(file)
        parameters = data["parameters"]
        stiffness = parameters["k_support"]
        if case.endswith("pad"):
            support = section("[[support]]", surface="bottom", kind="pad", normal=[0.0, 0.0, -1.0], stiffness=[0.0, 0.0, stiffness])
        else:
            support = section("[[support]]", surface="side", kind="elastic", stiffness=stiffness, damping=parameters["c_damping_side"])
        ran = Run(
            f"fenics-{case}",
            section("[body]", **GLASS, mesh=f"{folder}/mesh.msh", order=2),
            support,
            section("[impactor]", **STEEL, point=[0.0, 0.0, parameters["h"] / 2]),
            section("[contact]", localization="point"),
            section("[time]", end=data["integrator"]["T"], step=data["integrator"]["dt"], scheme="newmark"),
        )
        times, _, _, force, _ = columns(f"{folder}/series.csv")
        if not np.allclose(times, ran.time, rtol=1e-9, atol=1e-12):
            sys.exit(f"{case}: other steps than the fixture's")
        off = np.max(np.abs(ran.force - force)) / np.max(force)
        peaks = (number(np.max(each) * 1e-3, "kN", 7) for each in (force, ran.force))
        source = "legacy FEniCS, same mesh and step" if not rows else "the same"
        rows.append([f"{case}: peak; history of the force", source, *peaks, ratio(off)])
    return rows


def ngsolve():
    rows = []
    sizes = {"plate100": [1.5, 1.5, 0.1], "plate40": [1.5, 1.5, 0.04], "plate20": [0.5, 0.5, 0.02]}
    with open(f"{FIXTURES}/independent/errors.csv", encoding="ascii") as file:
        errors = {line["case"]: float(line["error"]) for line in csv.DictReader(file)}
    for case, own in errors.items():
        plate, stiffness, *off_centre = case.split("-")
        size = sizes[plate]
        point = {"plate40": [0.3, 0.2], "plate20": [0.1, 0.0]}[plate] if off_centre else [0.0, 0.0]
        times, accelerations = columns(f"{FIXTURES}/independent/{case}.csv")
        support = [section("[[support]]", surface="side", kind="elastic", stiffness=1e9)] if stiffness == "k1e9" else []
        ran = Run(
            f"ngsolve-{case}",
            section("[body]", **GLASS, size=size),
            *support,
            section("[impactor]", **STEEL, point=[*point, size[2] / 2]),
            time(times[-1], 1e-3),
        )
        spline, inside = Spline(times, accelerations), ran.time <= times[-1]
        off = np.max(np.abs(spline(ran.time[inside]) - ran.acceleration[inside])) / np.max(accelerations)
        peaks = number(top(times, accelerations)[1], "m/s²"), number(top(ran.time, ran.acceleration)[1], "m/s²")
        source = f"NGSolve, converged to {ratio(own)}"
        rows.append([f"{case}, {ran.model}: peak; first contact", source, *peaks, ratio(off)])
    return rows


def main():
    readings, reading = plate_frequencies()
    rows = [*hertz(), *zener(), *laws(), *equilibrium(), *karas(), *timoshenko(), *readings, *loaded_plate(), *fenics(), *ngsolve()]
    text = table(["what", "source", "independent", "ours", "difference"], rows)
    text += f"\n\nFrequencies are read to {ratio(reading)} of their value. This is the largest error of the same reading for cosines of known frequencies, and the largest difference between two probes."
    replace(sys.argv[2], "validation", text)


main()

"""What the two peers of laminated panes share: cells, Newmark's steps with Maxwell terms, how they are timed.

M a + K u + D sum G_i s_i = f F with s_i the strain that is left in the spring of a term, as a displacement: over a step in which u is
linear, s_i+ = E_i s_i + phi_i (u+ - u) exactly. Average acceleration; the contact's force by one scalar equation a step.
"""

import ngsolve
import numpy as np

import points
from contact import Impactor, force
from scene import arguments, short
from solid import Solid

ngsolve.SetNumThreads(1)


def history(system, solve, impactor, chain, end, step):
    """Times (s), accelerations of the impactor (m/s2) and tensions (Pa).

    `system` has stiffness, distortion, mass, load and stresses, of all unknowns or on a basis; solve(b) gives (K* + 4 M / dt^2)^-1 b with
    K* = K + sum phi_i G_i D.
    """
    decay, part = chain.over(step)
    weights, steps = chain.moduli, round(end / step)
    quarter = 0.25 * step * step
    place, velocity, acceleration = np.zeros((3, len(system.load)))
    strains = np.zeros((len(weights), len(system.load)))
    answer = solve(system.load)
    yielding = system.load @ answer + quarter / impactor.mass - impactor.dent
    q, rate, old = 0.0, impactor.speed, 0.0
    forces, tensions = np.zeros((2, steps + 1))
    for number in range(1, steps + 1):
        carried = (weights * decay) @ strains - (weights @ part) * place
        inert = system.mass @ (place / quarter + 4 / step * velocity + acceleration)
        trial = solve(inert - system.distortion @ carried)
        q += step * rate - quarter * old / impactor.mass
        f = force(q - system.load @ trial, yielding, impactor.hertz)
        new = trial + f * answer
        strains = decay[:, None] * strains + part[:, None] * (new - place)
        accelerated = (new - place) / quarter - 4 / step * velocity - acceleration
        velocity += 0.5 * step * (acceleration + accelerated)
        place, acceleration = new, accelerated
        q -= quarter * f / impactor.mass
        rate -= 0.5 * step * (old + f) / impactor.mass
        old = forces[number] = f
        tensions[number] = np.max(system.stresses @ place)
    return step * np.arange(steps + 1), forces / impactor.mass, tensions


def main(doc, name, prepare, choices):
    """Adds to the table the points of the peer `name` at its choices: cells, step (s), and what else prepare() takes.

    prepare(solid, chain, step, *more) gives the system and what solves with it ([`history`]).
    """
    scene, folder, budget = arguments(doc)
    if scene.chain is None:
        raise SystemExit("--layers SCENE.toml is needed, of which one relaxes")

    def build(cells, step, *more):
        system, solve = prepare(Solid.build(scene, cells), scene.chain, step, *more)
        impactor = Impactor.quarter(scene, cells.patch * scene.size[2])
        return lambda: history(system, solve, impactor, scene.chain, scene.end, step)

    settings = []
    for cells, step, *more in choices:
        counts = "×".join(str(len(line) - 1) for line in cells.lines(scene))
        vectors = "".join(f", {count} vectors" for count in more)
        text = f"{counts} Q{cells.order} of a quarter, r_p {cells.patch:.2g} h{vectors}, Δt {short(step)}"
        settings.append((text, lambda given=(cells, step, *more): points.timed(lambda: build(*given))))
    points.collect(name, settings, folder, budget)

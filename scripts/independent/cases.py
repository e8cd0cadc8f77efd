"""The impacts of the fixture: the paper's three plates hit in the centre, and two of them off it. SI units."""

from dataclasses import dataclass

from scene import Scene


@dataclass(frozen=True)
class Case:
    """A plate, where its top is hit (x, y, at least 0), and a time that lies after the end of the first contact."""

    scene: Scene
    point: tuple = (0.0, 0.0)

    @property
    def parities(self):
        """Those of u_z about the planes x = 0 and y = 0 that a force at the point excites, +1 even and -1 odd."""
        signs = [(1, -1) if x > 0 else (1,) for x in self.point]
        return [(x, y) for x in signs[0] for y in signs[1]]


PLATES = {"plate100": (1.5, 1.5, 0.1), "plate40": (1.5, 1.5, 0.04), "plate20": (0.5, 0.5, 0.02)}
ENDS = {"plate100": 2e-3, "plate40": 3.5e-3, "plate20": 2.5e-3}

CASES = {
    f"{plate}-k{stiffness}": Case(Scene(size, float(stiffness), ENDS[plate]))
    for plate, size in PLATES.items()
    for stiffness in ("0", "1e9")
} | {
    "plate40-k1e9-off": Case(Scene(PLATES["plate40"], 1e9, 6e-3), (0.3, 0.2)),
    "plate20-k0-off": Case(Scene(PLATES["plate20"], 0.0, 6e-3), (0.1, 0.0)),
}

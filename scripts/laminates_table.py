"""laminates_table.py OUT DOC: what scripts/laminates computed into OUT as tables of DOC.

OUT holds moduli.h5 (a sweep over the interlayer's modulus), plate.h5, and layerwise.h5, solid.h5 and laminate5.h5, each with the
processor's seconds in NAME.seconds; chart/work-precision.csv is of `ricochet chart`.
"""

import json
import sys

import h5py

from charts_table import chart, points
from markers import replace, table

LEVELS = [1e-1, 5e-2, 2e-2, 1e-2, 5e-3]
PEERS = {"NGSolve + Newmark": "NGSolve, Newmark", "NGSolve + Ritz vectors, relaxing": "NGSolve, Ritz"}

def largest(file, face):
    """The largest tension on a face, MPa."""
    return 1e-6 * file[f"series/stress/{face}/largest"][:].max()


def run(folder, name):
    """A run's numbers for a row: theory, unknowns, vectors, peak force, tensions, seconds."""
    with h5py.File(f"{folder}/{name}.h5", "r") as file:
        force = file["series/contact/force"][:].max()
        faces = {face: largest(file, face) for face in file["series/stress"] if "largest" in file[f"series/stress/{face}"]}
        return {
            "model": file.attrs["model"].decode(),
            "unknowns": int(file.attrs["unknowns"]),
            "reduction": file.attrs["reduction"].decode(),
            "force": force,
            "peak_time": file["series/time"][file["series/contact/force"][:].argmax()],
            "faces": faces,
            "error": float(file.attrs["first_contact_error"]) if "first_contact_error" in file.attrs else float("nan"),
        }


def moduli(folder):
    """Peak force and largest tension over the interlayer's modulus."""
    rows = []
    with h5py.File(f"{folder}/moduli.h5", "r") as file:
        members = file["members"]
        names = json.loads(file.attrs["faces"]) if "faces" in file.attrs else None
        for k, shear in enumerate(members["vary/material.interlayer.shear"][:]):
            face = int(members["largest_stress_face"][k])
            of_layer = names[face] if names else f"{face // 2 + 1}-{('upper', 'lower')[face % 2]}"
            rows.append([
                f"{shear:.1e}",
                f"{1e-3 * members['peak_force'][k]:.2f}",
                f"{1e-6 * members['largest_stress'][k]:.1f}",
                of_layer,
                f"{1e3 * members['peak_time'][k]:.3f}",
            ])
    plate = run(folder, "plate")
    face, value = max(plate["faces"].items(), key=lambda item: item[1])
    rows.append(["glass", f"{1e-3 * plate['force']:.2f}", f"{value:.1f}", face, f"{1e3 * plate['peak_time']:.3f}"])
    return table(["G of the interlayer, Pa", "peak force, kN", "largest tension, MPa", "on face", "time of the peak, ms"], rows)


def theories(folder):
    """What each theory costs on the same pane."""
    rows = []
    for name, what in [("layerwise", "10 / 0.76 / 10 mm"), ("solid", "the same"), ("laminate5", "6 / 0.76 / 6 / 0.76 / 6 mm")]:
        found = run(folder, name)
        with open(f"{folder}/{name}.seconds", encoding="utf-8") as file:
            seconds = float(file.read())
        face, value = max(found["faces"].items(), key=lambda item: item[1])
        rows.append([
            what, f"`{found['model']}`", found["unknowns"], f"{1e-3 * found['force']:.2f}", f"{value:.1f} on `{face}`",
            f"{found['error']:.1e}", f"{seconds:.2g}",
        ])
    head = ["pane", "theory", "unknowns", "peak force, kN", "largest tension, MPa", "estimated error, first contact", "processor time, s"]
    return table(head, rows)


if __name__ == "__main__":
    folder, document = sys.argv[1:]
    replace(document, "moduli", moduli(folder))
    replace(document, "theories", theories(folder))
    replace(document, "peers", chart(list(points(f"{folder}/chart/work-precision.csv", "error_first")), LEVELS, PEERS))

"""Tetrahedral meshes with named surfaces, as Gmsh MSH 4.1 ASCII files.

Format: Gmsh reference manual, "MSH file format". Read: first-order tetrahedra and triangles, surfaces by
physical name; other elements are refused, points and lines are skipped.
"""

from collections import namedtuple

import numpy as np

TRIANGLE, TETRAHEDRON = 2, 4
# Number of nodes by Gmsh element type, for the types that are read or skipped.
NODES = {1: 2, TRIANGLE: 3, TETRAHEDRON: 4, 15: 1}

# points: (n, 3) coordinates, m; cells: (m, 4) and surfaces[name]: (k, 3) node numbers from 0.
Mesh = namedtuple("Mesh", "points cells surfaces")


def read(path):
    """The Mesh in the file at `path`; ValueError where it is not one."""
    sections = _sections(path)
    version, binary, _ = sections["MeshFormat"][0].split()
    if version != "4.1" or binary != "0":
        raise ValueError(f"{path}: MSH {version} with binary flag {binary}; only 4.1 ASCII is read")
    names = {}
    for line in sections["PhysicalNames"][1:]:
        dim, tag, name = line.split(maxsplit=2)
        names[int(dim), int(tag)] = name.strip().strip('"')
    name_of = _surface_names(sections["Entities"], names)
    points, number = _nodes(sections["Nodes"])

    cells, surfaces = [], {}
    for dim, entity, kind, rows in _element_blocks(sections["Elements"]):
        if kind not in NODES:
            raise ValueError(f"{path}: element type {kind}; only first-order tetrahedra and triangles are read")
        nodes = number[rows[:, 1 : 1 + NODES[kind]]]
        if kind == TETRAHEDRON:
            cells.append(nodes)
        elif kind == TRIANGLE:
            for name in name_of.get(entity, []):
                surfaces.setdefault(name, []).append(nodes)
    if not cells:
        raise ValueError(f"{path}: no tetrahedra")
    return Mesh(points, np.vstack(cells), {name: np.vstack(blocks) for name, blocks in surfaces.items()})


def write(path, mesh, volume):
    """Writes `mesh` to `path`, its volume under the physical name `volume`. Coordinates keep all their bits."""
    surfaces = list(mesh.surfaces.items())
    n_points = len(mesh.points)
    volume_tag = len(surfaces) + 1
    out = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$PhysicalNames", str(volume_tag)]
    out += [f'2 {tag} "{name}"' for tag, (name, _) in enumerate(surfaces, 1)]
    out += [f'3 {volume_tag} "{volume}"', "$EndPhysicalNames"]

    out += ["$Entities", f"0 0 {len(surfaces)} 1"]
    for tag, (_, triangles) in enumerate(surfaces, 1):
        out.append(f"{tag} {_bounds(mesh.points[triangles.ravel()])} 1 {tag} 0")
    bounding = " ".join(str(tag) for tag in range(1, volume_tag))
    out.append(f"1 {_bounds(mesh.points)} 1 {volume_tag} {len(surfaces)} {bounding}".rstrip())
    out.append("$EndEntities")

    out += ["$Nodes", f"1 {n_points} 1 {n_points}", f"3 1 0 {n_points}"]
    out += [str(tag) for tag in range(1, n_points + 1)]
    out += [_numbers(point) for point in mesh.points]
    out.append("$EndNodes")

    blocks = [(2, tag, TRIANGLE, triangles) for tag, (_, triangles) in enumerate(surfaces, 1)]
    blocks.append((3, 1, TETRAHEDRON, mesh.cells))
    total = sum(len(nodes) for *_, nodes in blocks)
    out += ["$Elements", f"{len(blocks)} {total} 1 {total}"]
    element = 0
    for dim, entity, kind, nodes in blocks:
        out.append(f"{dim} {entity} {kind} {len(nodes)}")
        for row in nodes:
            element += 1
            out.append(f"{element} " + " ".join(str(node + 1) for node in row))
    out.append("$EndElements")
    with open(path, "w", encoding="ascii") as file:
        file.write("\n".join(out) + "\n")


def _numbers(values):
    return " ".join(f"{value:.17g}" for value in values)


def _bounds(points):
    return f"{_numbers(points.min(axis=0))} {_numbers(points.max(axis=0))}"


def _sections(path):
    """Lines of each section by its name."""
    sections, name = {}, None
    with open(path, encoding="utf-8") as file:
        for line in file:
            if line.startswith("$End"):
                name = None
            elif line.startswith("$"):
                name = line[1:].strip()
                sections[name] = []
            elif name:
                sections[name].append(line)
    for name in ("MeshFormat", "PhysicalNames", "Entities", "Nodes", "Elements"):
        if name not in sections:
            raise ValueError(f"{path}: no section ${name}")
    return sections


def _surface_names(lines, names):
    """Physical names of each surface entity by the entity's tag."""
    n_points, n_curves, n_surfaces, _ = (int(word) for word in lines[0].split())
    first = 1 + n_points + n_curves
    found = {}
    for line in lines[first : first + n_surfaces]:
        words = line.split()
        tags = words[8 : 8 + int(words[7])]  # after the tag and six bounds
        found[int(words[0])] = [names[2, int(tag)] for tag in tags if (2, int(tag)) in names]
    return found


def _nodes(lines):
    """Coordinates, and an array from the file's node tags to their rows."""
    n_blocks, n_nodes, _, highest = (int(word) for word in lines[0].split())
    points = np.empty((n_nodes, 3))
    number = np.full(highest + 1, -1)
    at, row = 1, 0
    for _ in range(n_blocks):
        count = int(lines[at].split()[3])
        tags = [int(line) for line in lines[at + 1 : at + 1 + count]]
        number[tags] = np.arange(row, row + count)
        for line in lines[at + 1 + count : at + 1 + 2 * count]:
            points[row] = [float(word) for word in line.split()[:3]]
            row += 1
        at += 1 + 2 * count
    return points, number


def _element_blocks(lines):
    """Yields (dimension, entity, element type, rows of element tag and node tags) of each block."""
    at = 1
    for _ in range(int(lines[0].split()[0])):
        dim, entity, kind, count = (int(word) for word in lines[at].split())
        rows = np.array([line.split() for line in lines[at + 1 : at + 1 + count]], dtype=int)
        yield dim, entity, kind, rows
        at += 1 + count

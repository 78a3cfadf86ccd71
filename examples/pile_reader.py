"""Reads what `scree export CHECKPOINT -o FOLDER` writes, with nothing but Python: for the examples beside this."""
from __future__ import annotations

import json
import pathlib
import struct
from typing import Any, Sequence


def read_stl(path: pathlib.Path, unit: float) -> tuple[list[list[float]], list[list[int]]]:
    """Vertices in metres and triangles of a binary STL, equal corners united."""
    data = pathlib.Path(path).read_bytes()
    vertices: list[list[float]] = []
    triangles: list[list[int]] = []
    known: dict[tuple[float, ...], int] = {}
    for k in range(struct.unpack_from("<I", data, 80)[0]):
        corners = []
        values = struct.unpack_from("<9f", data, 84 + 50 * k + 12)
        for i in range(0, 9, 3):
            point = values[i:i + 3]
            if point not in known:
                known[point] = len(vertices)
                vertices.append([unit * x for x in point])
            corners.append(known[point])
        triangles.append(corners)
    return vertices, triangles


def rotation(q: Sequence[float]) -> list[list[float]]:
    """The matrix of a unit quaternion w, x, y, z."""
    w, x, y, z = q
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]


def turn(matrix: Sequence[Sequence[float]], vector: Sequence[float]) -> list[float]:
    return [sum(a * b for a, b in zip(row, vector)) for row in matrix]


def read_pile(folder: str | pathlib.Path) -> dict[str, Any]:
    """pile.json as a dictionary; shapes of meshes get `vertices` and `triangles`, in their own frame."""
    folder = pathlib.Path(folder)
    pile: dict[str, Any] = json.loads((folder / "pile.json").read_text())
    for shape in pile["shapes"]:
        if shape["mesh_file"]:
            shape["vertices"], shape["triangles"] = read_stl(folder / shape["mesh_file"], pile["unit_m"])
    return pile


def inertia_in_space(pile: dict[str, Any], body: dict[str, Any]) -> list[float]:
    """Six values xx yy zz xy xz yz, kg m2, about the body's centre, along the axes of space."""
    shape = pile["shapes"][body["shape"]]
    density = body["mass"] / shape["volume"]
    r = rotation(body["orientation"])
    moments = [density * m for m in shape["inertia_per_density"]]
    full = [[sum(r[i][k] * moments[k] * r[j][k] for k in range(3)) for j in range(3)] for i in range(3)]
    return [full[0][0], full[1][1], full[2][2], full[0][1], full[0][2], full[1][2]]

#!/usr/bin/env python3
"""Heaps by `scree repose` with nothing but a file: bodies of several sizes, the time foretold and the time it took.

usage: heaps.py DIR DATA      DATA: a folder with stone_E22.ply and weee_cam1.ply
A stone, a device and a cube at 1, 6.5, 65 and 400 mm across, one thread each. A line each: time foretold and taken, the angle
by volume with its error, and how it ended. Heaps that were made are read again."""
import json
import pathlib
import re
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "evidence"))
from common import PROGRAM, read_stl, write_stl  # noqa: E402

CORNERS = [tuple((k >> axis & 1) - 0.5 for axis in range(3)) for k in range(8)]
FACES = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))


def triangles(name, data, folder):
    if name == "cube":
        return [[CORNERS[f[0]], CORNERS[f[k]], CORNERS[f[k + 1]]] for f in FACES for k in (1, 2)]
    if not (folder / "level").exists():
        subprocess.run([PROGRAM, "choose", str(data / name) + ".ply", "-u", "mm", "-q", "-o", folder / "level"], check=True, stdout=subprocess.DEVNULL)
    return read_stl(folder / "level" / f"{name}.stl")


def scaled(faces, across):
    flat = [p for face in faces for p in face]
    size = max(max(p[k] for p in flat) - min(p[k] for p in flat) for k in range(3))
    return [[[v * across / size for v in p] for p in face] for face in faces]


def heap(name, across, data, folder):
    folder.mkdir(parents=True, exist_ok=True)
    scan = folder / f"{name}.stl"
    write_stl(scan, scaled(triangles(name, data, folder.parent / name), across))
    done = subprocess.run([PROGRAM, "repose", scan, "-u", "mm", "-o", folder / "out", "-f", "-j", "1", "--no-picture"],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    (folder / "said.txt").write_text(done.stdout)


def seconds(text):
    found = re.search(r"about ([\d.]+) (s|min|h)\b", text)
    return float(found[1]) * {"s": 1, "min": 60, "h": 3600}[found[2]] if found else float("nan")


def main(folder, data):
    for name in ("stone_E22", "weee_cam1", "cube"):
        for across in (1, 6.5, 65, 400):
            place = folder / f"{name}-{across}"
            if not (place / "out" / "result.json").exists():
                heap(name, across, data, place)
            told = json.loads((place / "out" / "result.json").read_text())
            made = json.loads((place / "out" / "provenance.json").read_text())
            print(name, f"{across} mm", f"foretold {seconds((place / 'said.txt').read_text()):.0f} s", f"took {made['elapsed_s']:.0f} s, {made['processor_s']:.0f} s of a processor", told["sentence"], told["state"], sep="; ", flush=True)


if len(sys.argv) != 3:
    sys.exit(__doc__)
main(pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve())

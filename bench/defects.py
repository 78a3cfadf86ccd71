#!/usr/bin/env python3
"""Defects against what scree and admesh (Debian) make of them: prints the tables of docs/reference/defects.md.

usage: bench/defects.py SCREE [FOLDER_OF_SCANS]

Each file is checked and repaired by scree, and repaired by `admesh` with its default fixes; what
either wrote is judged by `scree check`. admesh reads STL only: other formats are handed to it as the
binary STL of the same facets. Defects are generated here on a sphere or a box, in single precision.
"""
import json, math, os, struct, subprocess, sys, tempfile

SCREE = os.path.abspath(sys.argv[1])
SCANS = sys.argv[2] if len(sys.argv) > 2 else None


# Left out of messages.
FOLDERS = [os.path.abspath(SCANS) + "/"] if SCANS else []


def run(*words, timeout=600):
    done = subprocess.run(words, capture_output=True, encoding="utf-8", errors="replace",
                          timeout=timeout)
    out, said = done.stdout, done.stderr
    for folder in FOLDERS:
        out, said = out.replace(folder, ""), said.replace(folder, "")
    return done.returncode, out, said


# ---- Generated defects ----

def sphere(level=3, radius=10.0, centre=(0, 0, 0)):
    g = (1 + 5 ** 0.5) / 2
    v = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g), (0, 1, -g),
         (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    f = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2),
         (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5),
         (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]

    def unit(p):
        n = math.sqrt(sum(c * c for c in p))
        return tuple(c / n for c in p)

    facets = [tuple(unit(v[i]) for i in t) for t in f]
    for _ in range(level):
        finer = []
        for a, b, c in facets:
            ab, bc, ca = (unit(tuple(x + y for x, y in zip(p, q))) for p, q in ((a, b), (b, c), (c, a)))
            finer += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        facets = finer
    return [tuple(tuple(radius * x + o for x, o in zip(p, centre)) for p in t) for t in facets]


def box(size, n=4, origin=(0, 0, 0)):
    facets = []
    for axis in range(3):
        for end in (0, 1):
            for i in range(n):
                for j in range(n):
                    def at(u, w):
                        p = [0.0] * 3
                        p[axis] = size * end
                        p[(axis + 1) % 3] = size * u / n
                        p[(axis + 2) % 3] = size * w / n
                        return tuple(x + o for x, o in zip(p, origin))
                    a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
                    quad = [(a, b, c), (a, c, d)]
                    facets += quad if end else [turned(t) for t in quad]
    return facets


def turned(t):
    return (t[0], t[2], t[1])


def near(t, direction):
    """How far the facet's first corner lies along the direction, as a share of its distance."""
    n = math.sqrt(sum(c * c for c in t[0]))
    return sum(x * d for x, d in zip(t[0], direction)) / n


def generated():
    s = sphere()
    up = (0, 0, 1)
    cap = [t for t in s if near(t, up) > 0.95]
    open_cap = [t for t in s if t not in cap]
    yield "clean sphere", s
    yield "3 facets missing", s[:100] + s[101:500] + s[501:900] + s[901:]
    yield f"hole of {len(cap)} facets", open_cap
    yield "hemisphere (hole of a third of the edges)", [t for t in sphere(4) if near(t, up) < 0]
    yield "every 7th facet turned", [turned(t) if i % 7 == 0 else t for i, t in enumerate(s)]
    yield "inside out", [turned(t) for t in s]
    yield "20 facets doubled", s + s[::64]
    yield "20 facets doubled and turned", s + [turned(t) for t in s[::64]]
    yield "10 facets without area", s + [(a, b, tuple((x + y) / 2 for x, y in zip(a, b)))
                                         for a, b, _ in s[::128]]
    yield "seam open by 1e-5 of the size", [tuple(tuple(x + (2e-4 if k == 0 else 0) for k, x in
                                            enumerate(p)) for p in t) if near(t, up) > 0.5 else t for t in s]
    fine = box(10.0, 8)
    yield "T-junctions (one face coarse)", [t for t in fine if not all(p[2] == 10 for p in t)] + \
        [t for t in box(10.0, 1) if all(p[2] == 10 for p in t)]
    yield "fin of 2 facets", s + [(s[5][0], s[5][1], (20.0, 20.0, 20.0)), (s[5][1], (20.0, 21.0, 20.0),
                                                                         (20.0, 20.0, 20.0))]
    half = box(10.0, origin=(10, 0, 0))
    wall = [t for t in half if all(p[0] == 10 for p in t)]
    yield "two boxes glued, one wall between", box(10.0) + [t for t in half if t not in wall]
    yield "two boxes sharing an edge", box(10.0) + box(10.0, origin=(10, 10, 0))
    yield "two boxes sharing a corner", box(10.0) + box(10.0, origin=(10, 10, 10))
    yield "two boxes face on face, alike", box(10.0) + box(10.0, origin=(10, 0, 0))
    yield "two boxes face on face, shifted", box(10.0) + box(10.0, origin=(10, 1.3, 2.1))
    yield "cavity", box(30.0) + [turned(t) for t in sphere(2, 4.0, (15, 15, 15))]
    yield "cavity wound outward (nested)", box(30.0) + sphere(2, 4.0, (15, 15, 15))
    yield "debris outside and inside", box(30.0) + sphere(1, 0.4, (40, 5, 5)) + sphere(1, 0.4, (11, 12, 13))
    yield "overlapping boxes", box(10.0) + box(10.0, origin=(4.1, 3.3, 2.7))
    spike = s[7][0]
    yield "spike through the far side", [tuple(tuple(-1.3 * x for x in p) if p == spike else p for p in t)
                                         for t in s]
    yield "not a number in 1 facet", s[:50] + [((math.nan,) * 3,) + s[50][1:]] + s[51:]


def write_stl(path, facets):
    with open(path, "wb") as f:
        f.write(b"defect".ljust(80, b"\0") + struct.pack("<I", len(facets)))
        for t in facets:
            f.write(struct.pack("<12fH", 0, 0, 0, *(c for p in t for c in p), 0))


# ---- The two programs ----

def check(path):
    _, out, err = run(SCREE, "check", "--json", path)
    try:
        return json.loads(out)[0]
    except (ValueError, IndexError):
        return {"failure": err.strip()}


def defects_of(report):
    if "failure" in report:
        text = report["failure"].split(": ", 1)[-1]
        return "not read: " + (text if len(text) < 90 else text[:87] + "...")
    found = {k: n for k, n in report["check"]["defects"].items() if n}
    text = ", ".join(f"{n} {k.replace('_', ' ')}" for k, n in found.items()) or "none"
    if "overlapping_shell_pairs" in found or "nested_shells" in found:
        volume = report["check"].get("volume")
        text += f"; the union has {volume * 1e9:.6g} mm3" if volume else "; the union's volume is unknown"
    return text


def by_scree(path, folder):
    out = os.path.join(folder, "scree.stl")
    if os.path.exists(out):
        os.remove(out)
    code, text, err = run(SCREE, "repair", "--json", path, "-o", out)
    if not text:
        return "refused: " + err.strip().split(": ", 2)[-1][:90]
    report = json.loads(text)[0]
    done = ", ".join(f"{n} {k.replace('_', ' ')}" for k, n in report["done"].items() if n)
    if code == 0:
        return "nothing to do" if report["check"]["usable"] and not done else f"repaired: {done}"
    rest = {k: n for k, n in report["after"]["defects"].items() if n}
    return "refused: " + (", ".join(f"{n} {k.replace('_', ' ')}" for k, n in rest.items())
                          or report["failure"][:90])


def by_admesh(path, folder):
    out = os.path.join(folder, "admesh.stl")
    if os.path.exists(out):
        os.remove(out)
    try:
        code, _, err = run("admesh", "-b", out, path, timeout=15)
    except subprocess.TimeoutExpired:
        return "does not end (stopped after 15 s)"
    if code != 0 or not os.path.exists(out):
        return "failed: " + (err.strip().splitlines() or ["exit code %d" % code])[-1][:60]
    report = check(out)
    if "failure" in report:
        return "wrote what cannot be read"
    return "repaired" if report["check"]["usable"] else "left: " + defects_of(report)


def as_stl(path, folder):
    """The same facets as a binary STL, for admesh."""
    if path.lower().endswith(".stl"):
        return path
    out = os.path.join(folder, "facets.stl")
    facets = []
    with open(path, "rb") as f:
        head = f.read(3)
    if head == b"ply" or path.endswith(".ply"):
        return None
    vertices = []
    for line in open(path):
        words = line.split()
        if words[:1] == ["v"]:
            vertices.append(tuple(float(w) for w in words[1:4]))
        elif words[:1] == ["f"]:
            corner = [int(w.split("/")[0]) for w in words[1:]]
            corner = [vertices[i - 1 if i > 0 else i] for i in corner]
            facets += [(corner[0], corner[k], corner[k + 1]) for k in range(1, len(corner) - 1)]
    write_stl(out, facets)
    return out


def row(name, path, folder):
    report = check(path)
    stl = as_stl(path, folder)
    sound = "check" in report and report["check"]["usable"]
    print(f"| {name} | {defects_of(report)} | {by_scree(path, folder)} "
          f"| {by_admesh(stl, folder) if stl else '(PLY)'}{' (sound before)' if sound else ''} |", flush=True)


def main():
    header = "| what | scree finds | scree repair | admesh, judged by scree check |\n|---|---|---|---|"
    with tempfile.TemporaryDirectory() as folder:
        FOLDERS.append(folder + "/")
        print("### Generated defects\n\n" + header)
        for name, facets in generated():
            path = os.path.join(folder, "defect.stl")
            write_stl(path, facets)
            row(name, path, folder)
        if SCANS:
            print("\n### Files\n\n" + header)
            for name in sorted(os.listdir(SCANS)):
                if name.rsplit(".", 1)[-1].lower() in ("stl", "ply", "obj", "off"):
                    row(name, os.path.join(SCANS, name), folder)


main()

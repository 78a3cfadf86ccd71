#!/usr/bin/env python3
"""What the exact search for self-intersections costs as meshes grow, on layouts that defeat grids and boxes.

usage: bench/layouts.py [SCREE]      the program; default build/release/bin/scree

Processor seconds of `scree check` (least of three), less those of `scree check --fast`, at three sizes of each
layout: a scan, the same with a vertex pulled through its far side, slanted twigs of long thin triangles side by
side, two cones of slivers round one vertex each, and twigs that all cross in the middle. Writes
results/layouts.csv.
"""
import json, math, os, platform, resource, struct, subprocess, sys, tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(ROOT, "bench", "evidence"))
from common import read_stl
SCREE = sys.argv[1] if len(sys.argv) > 1 else os.path.join(ROOT, "build/release/bin/scree")
AXIS = (0.7784989, 0.5449492, 0.3113996)  # of slanted things
ACROSS = (-0.5734623, 0.8192319, 0.0)
ASIDE = tuple(AXIS[(k + 1) % 3] * ACROSS[(k + 2) % 3] - AXIS[(k + 2) % 3] * ACROSS[(k + 1) % 3] for k in range(3))


def point(along, x, y):
    return tuple(along * a + x * b + y * c for a, b, c in zip(AXIS, ACROSS, ASIDE))


def write_stl(path, facets):
    with open(path, "wb") as f:
        f.write(b"layout".ljust(80, b"\0") + struct.pack("<I", len(facets)))
        for t in facets:
            f.write(struct.pack("<12fH", 0, 0, 0, *(c for p in t for c in p), 0))


def tube(sides, at, length, out):
    """A closed twig: sides of two long triangles each, fans for caps."""
    for i in range(sides):
        a, b = (2 * math.pi * k / sides for k in (i, (i + 1) % sides))
        low = [at(0, math.cos(w), math.sin(w)) for w in (a, b)]
        high = [at(length, math.cos(w), math.sin(w)) for w in (a, b)]
        out += [(low[0], low[1], high[0]), (low[1], high[1], high[0]),
                (low[1], low[0], at(0, 0, 0)), (high[0], high[1], at(length, 0, 0))]


def twigs(count):
    facets, each = [], 48
    side = math.ceil(math.sqrt(count / each))
    for n in range(count // each):
        x, y = 3 * (n % side), 3 * (n // side)
        tube(12, lambda l, u, v: point(l, x + u, y + v), 2000, facets)
    return facets


def crossing(count):
    """Twigs of the same number, thinner the more they are, each through the middle: as many pairs as twigs, not
    more, since the middle of each is shifted along the axis that they turn round."""
    facets, each = [], 48
    twig_count = count // each
    for n in range(twig_count):
        c, s = math.cos(math.pi * n / twig_count), math.sin(math.pi * n / twig_count)
        h = 1.5 * n  # less than two radii: neighbours cross
        tube(12, lambda l, u, v: tuple(p + q for p, q in zip(
            point(h, 0, 0), point(u, (l - 1000) * c - v * s, (l - 1000) * s + v * c))), 2000, facets)
    return facets


def cones(count):
    n, facets = count // 4, []
    for h in (0, 300):
        for i in range(n):
            a, b = (2 * math.pi * k / n for k in (i, (i + 1) % n))
            p, q = (point(h, 100 * math.cos(w), 100 * math.sin(w)) for w in (a, b))
            facets += [(p, q, point(h + 10, 0, 0)), (q, p, point(h - 10, 0, 0))]
    return facets


def scan(folder, count, spiked):
    path = os.path.join(folder, "scan.stl")
    resolution = 0.27 * math.sqrt(786864 / count)
    subprocess.run([SCREE, "sample", "-q", "fp-1", "--resolution", f"{resolution:.4g}mm", "-f", "-o", path],
                   check=True, stdout=subprocess.DEVNULL)
    facets = read_stl(path)
    if spiked:
        low, high = (tuple(f(t[0][k] for t in facets) for k in range(3)) for f in (min, max))
        tip = facets[0][0]
        far = tuple(a + b - c for a, b, c in zip(low, high, tip))
        facets = [tuple(far if p == tip else p for p in t) for t in facets]
    return facets


def seconds(*options):
    least, report = math.inf, None
    for _ in range(3):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run([SCREE, "check", "--json", *options], capture_output=True, text=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        least = min(least, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
        report = json.loads(done.stdout)[0]["check"]
    return least, report


def main():
    version = subprocess.run([SCREE, "--version"], capture_output=True, text=True).stdout.split("\n")[0]
    commit = subprocess.run(["git", "-C", ROOT, "rev-parse", "--short", "HEAD"], capture_output=True, text=True).stdout
    lines = [f"# {version}, commit {commit.strip()}", f"# machine: {os.cpu_count()} processors, {platform.machine()}",
             f"# load before the run: {' '.join(f'{x:.2f}' for x in os.getloadavg())}", "# command: bench/layouts.py",
             "layout,triangles,pairs,check_s,check_fast_s,search_us_per_triangle"]
    with tempfile.TemporaryDirectory() as folder:
        for name, make in (("scan", lambda n: scan(folder, n, False)), ("scan with a spike", lambda n: scan(folder, n, True)),
                           ("twigs side by side", twigs), ("cones of slivers", cones), ("twigs that cross", crossing)):
            for size in (50000, 200000, 800000):
                path = os.path.join(folder, "layout.stl")
                facets = make(size)
                write_stl(path, facets)
                (whole, report), (fast, _) = seconds(path), seconds("--fast", path)
                pairs = sum(report["defects"][k] for k in ("crossing_pairs", "touching_pairs", "overlapping_pairs"))
                lines.append(f"{name},{len(facets)},{pairs},{whole:.3f},{fast:.3f},{1e6 * (whole - fast) / len(facets):.3f}")
                print(lines[-1], flush=True)
    with open(os.path.join(ROOT, "bench/results/layouts.csv"), "w") as f:
        f.write("\n".join(lines) + "\n")


main()

#!/usr/bin/env python3
"""Whether the recommended choice holds what it promises. Exit code 1 where not.

  fidelity.py PROGRAM scans FILE...    every recommended level keeps every tolerance by `scree distance` with a million
                                       samples and `scree measure`, and the largest error over its tolerance is near 1
  fidelity.py PROGRAM seeds [SAMPLE...]    the nine samples at 1 mm under ten seeds of noise: spread of ln N
  fidelity.py PROGRAM noise [SAMPLE...]    noise up to 0.15 of the spacing against none: ratio of N
  fidelity.py PROGRAM spacing [SAMPLE...]  spacings of 1, 0.5 and 0.27 mm: ratio of N
  fidelity.py PROGRAM moved FILE...    turned, moved, scaled, in another unit: ratio of N
Lines are printed as they come."""
import json, math, os, statistics, struct, subprocess, sys, tempfile

PROGRAM = sys.argv[1]
DEVICES = [f"{kind}-{k}" for kind in ("dc", "fp", "sp") for k in (1, 2, 3)]


def scree(*words):
    return subprocess.run([PROGRAM, *map(str, words)], check=True, capture_output=True, text=True).stdout


def choose(*words):
    return json.loads(scree("choose", "--json", *words))[0]


def sample(name, spacing, noise, seed=1):
    chosen = choose(f"sample:{name}", "--resolution", f"{spacing}mm", "--noise", f"{noise}mm", "--sample-seed", seed)
    return chosen["recommended"]["triangle_count"]


def inertia(path):
    return [x for row in json.loads(scree("measure", "--json", path))[0]["inertia"] for x in row]


def corners(path):
    """The vertices of a binary STL."""
    data = open(path, "rb").read()
    count = int.from_bytes(data[80:84], "little")
    return {row[k : k + 3] for row in struct.iter_unpack("<12fH", data[84 : 84 + 50 * count]) for k in (3, 6, 9)}


def widths(points, directions):
    along = ([a * x + b * y + c * z for x, y, z in points] for a, b, c in directions)
    return [max(values) - min(values) for values in along]


def widest_change(scan, level):
    """Along the axes of the scan's least box, and from each to the others in seven steps."""
    axes = json.loads(scree("measure", "--json", scan))[0]["oriented_axes"]
    steps = [(i, j, k) for i in range(-7, 8) for j in range(-7, 8) for k in range(8) if abs(i) + abs(j) + k == 7]
    directions = [[sum(s * axis[c] for s, axis in zip(step, axes)) / math.hypot(*step) for c in range(3)] for step in steps]
    was, now = widths(read_off(scan)[0], directions), widths(corners(level), directions)
    return max(abs(b / a - 1) for a, b in zip(was, now))


def check_scan(path):
    """The answer's errors, by other means."""
    with tempfile.TemporaryDirectory() as folder:
        answer = choose(path, "-o", os.path.join(folder, "out"), "-f")
        level = os.path.join(folder, "out", answer["mesh_file"].rsplit("/", 1)[-1])
        asked = answer["options"]["tolerances"]
        size, told = answer["scan"]["size"], answer["recommended"]
        words = ["--json", "--points", 1000000, "--gap", 0.002]
        whole = os.path.join(folder, "scan.off")
        scree("repair", path, "-o", whole)
        far = json.loads(scree("distance", *words, path, level))
        scan, here = inertia(path), inertia(level)
        found = {"mean_distance": max(far["forward"]["mean"], far["backward"]["mean"]) / size,
                 "hausdorff": far["hausdorff"] / size,
                 "inertia": math.dist(scan, here) / math.hypot(*scan),
                 "widths": widest_change(whole, level)}
        load = max(found.get(name, told["errors"].get(name, 0)) / asked[name] for name in asked)
        print(f"{os.path.basename(path)}: {told['triangle_count']} triangles, {load:.3f} of what is allowed, "
              + ", ".join(f"{name} {share:.4%}" for name, share in found.items()) + f"; {told['limited_by']}", flush=True)
        return load <= 1


def spread(counts):
    return statistics.stdev(map(math.log, counts))


def seeds(names):
    for name in names or DEVICES:
        counts = [sample(name, 1, 0.02, seed) for seed in range(1, 11)]
        print(f"{name}: {counts}, standard deviation of ln N {spread(counts):.3f}", flush=True)
        yield spread(counts) <= 0.12


def noise(names):
    for name in names or DEVICES[::3]:
        clean = sample(name, 0.5, 0)
        for share in (0.05, 0.1, 0.15):
            ratio = sample(name, 0.5, 0.5 * share) / clean
            print(f"{name}, noise {share} of the spacing: {ratio:.3f} of {clean}", flush=True)
            yield abs(ratio - 1) <= 0.15


def spacing(names):
    for name in names or DEVICES:
        counts = [sample(name, step, 0.02) for step in (1, 0.5, 0.27)]
        print(f"{name} at 1, 0.5, 0.27 mm: {counts}, {max(counts) / min(counts):.3f}", flush=True)
        yield max(counts) / min(counts) <= 1.25


def read_off(path):
    words = open(path, encoding="utf-8").read().split("\n")
    rows = [line.split() for line in words if line and not line.startswith("#")]
    count = int(rows[1][0])
    return [list(map(float, row[:3])) for row in rows[2 : 2 + count]], [row[:4] for row in rows[2 + count :]]


def write_off(path, points, facets):
    with open(path, "w", encoding="utf-8") as file:
        file.write(f"OFF\n{len(points)} {len(facets)} 0\n")
        file.writelines(" ".join(map(repr, p)) + "\n" for p in points)
        file.writelines(" ".join(f) + "\n" for f in facets)


def turned(p):
    """By 0.7 about (1, 2, 2) / 3."""
    axis, cosine, sine = (1 / 3, 2 / 3, 2 / 3), math.cos(0.7), math.sin(0.7)
    along = sum(a * x for a, x in zip(axis, p))
    across = [axis[(i + 1) % 3] * p[(i + 2) % 3] - axis[(i + 2) % 3] * p[(i + 1) % 3] for i in range(3)]
    return [p[i] * cosine + across[i] * sine + axis[i] * along * (1 - cosine) for i in range(3)]


def moved(paths):
    for path in paths:
        with tempfile.TemporaryDirectory() as folder:
            plain, other = os.path.join(folder, "plain.off"), os.path.join(folder, "other.off")
            scree("export", path, "-o", plain)
            points, facets = read_off(plain)
            size = max(max(p[i] for p in points) - min(p[i] for p in points) for i in range(3))
            ways = {"turned": turned, "moved": lambda p: [x + 3 * size for x in p], "scaled": lambda p: [2.7 * x for x in p]}
            write_off(plain, points, facets)
            first = choose(plain)["recommended"]["triangle_count"]
            for name, way in ways.items():
                write_off(other, [way(p) for p in points], facets)
                yield told(path, name, choose(other)["recommended"]["triangle_count"], first)
            yield told(path, "in inches", choose(plain, "--unit", "inch")["recommended"]["triangle_count"], first)


def told(path, way, count, first):
    print(f"{os.path.basename(path)} {way}: {count / first:.3f} of {first}", flush=True)
    return abs(count / first - 1) <= 0.03


def main():
    what, words = sys.argv[2], sys.argv[3:]
    runs = {"scans": lambda: (check_scan(path) for path in words), "seeds": lambda: seeds(words),
            "noise": lambda: noise(words), "spacing": lambda: spacing(words),
            "moved": lambda: moved(words)}
    return 0 if all(list(runs[what]())) else 1


sys.exit(main())

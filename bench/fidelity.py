#!/usr/bin/env python3
"""Whether the recommended choice holds what it promises. Exit code 1 where not.

  fidelity.py PROGRAM scans FILE...    every recommended level keeps every tolerance by `scree distance` with a million
                                       samples and `scree measure`, and the largest error over its tolerance is near 1
  fidelity.py PROGRAM seeds            the nine samples at 1 mm under ten seeds of noise: spread of ln N
  fidelity.py PROGRAM noise            noise up to 0.15 of the spacing against none: ratio of N
  fidelity.py PROGRAM spacing          spacings of 1, 0.5 and 0.27 mm: ratio of N
  fidelity.py PROGRAM moved FILE...    turned, moved, scaled, in another unit: ratio of N
  fidelity.py PROGRAM physics FOLDER SET=FILE,FILE,...   a study of each set at an eighth to twice the recommended counts;
                                       goes on where it was stopped
Lines are printed as they come."""
import json, math, os, statistics, subprocess, sys, tempfile

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


def check_scan(path):
    """The answer's errors, by other means."""
    with tempfile.TemporaryDirectory() as folder:
        answer = choose(path, "-o", os.path.join(folder, "out"), "-f")
        level = os.path.join(folder, "out", answer["mesh_file"].rsplit("/", 1)[-1])
        asked = answer["options"]["tolerances"]
        size, told = answer["scan"]["size"], answer["recommended"]
        words = ["--json", "--points", 1000000, "--gap", 0.002]
        far = json.loads(scree("distance", *words, path, level))
        scan, here = inertia(path), inertia(level)
        found = {"mean_distance": max(far["forward"]["mean"], far["backward"]["mean"]) / size,
                 "hausdorff": far["hausdorff"] / size,
                 "inertia": math.dist(scan, here) / math.hypot(*scan)}
        load = max(found.get(name, told["errors"].get(name, 0)) / asked[name] for name in asked)
        print(f"{os.path.basename(path)}: {told['triangle_count']} triangles, {load:.3f} of what is allowed, "
              + ", ".join(f"{name} {share:.4%}" for name, share in found.items()) + f"; {told['limited_by']}", flush=True)
        return load <= 1


def spread(counts):
    return statistics.stdev(map(math.log, counts))


def seeds():
    for name in DEVICES:
        counts = [sample(name, 1, 0.02, seed) for seed in range(1, 11)]
        print(f"{name}: {counts}, standard deviation of ln N {spread(counts):.3f}", flush=True)
        yield spread(counts) <= 0.12


def noise():
    for name in DEVICES[::3]:
        clean = sample(name, 0.5, 0)
        for share in (0.05, 0.1, 0.15):
            ratio = sample(name, 0.5, 0.5 * share) / clean
            print(f"{name}, noise {share} of the spacing: {ratio:.3f} of {clean}", flush=True)
            yield abs(ratio - 1) <= 0.15


def spacing():
    for name in DEVICES:
        counts = [sample(name, step, 0.02) for step in (1, 0.5, 0.27)]
        print(f"{name} at 1, 0.5, 0.27 mm: {counts}, {max(counts) / min(counts):.3f}", flush=True)
        yield max(counts) / min(counts) <= 1.25


def moved(paths):
    for path in paths:
        first = choose(path)["recommended"]["triangle_count"]
        with tempfile.TemporaryDirectory() as folder:
            other = os.path.join(folder, "moved.ply")
            scree("export", path, "-o", other)
            for unit in ("inch", "m"):
                ratio = choose(other, "--unit", unit)["recommended"]["triangle_count"] / first
                print(f"{path} in {unit}: {ratio:.3f} of {first}", flush=True)
                yield abs(ratio - 1) <= 0.03


def physics(folder, sets):
    """Angle of repose, packing, coordination and rotation at an eighth to twice the recommended counts."""
    os.makedirs(folder, exist_ok=True)
    for name, paths in (one.split("=", 1) for one in sets):
        levels = []
        for factor in (0.125, 0.25, 0.5, 1, 1.5, 2):
            files = []
            for path in paths.split(","):
                short = os.path.splitext(os.path.basename(path.replace("sample:", "")))[0]
                level = os.path.join(folder, f"{name}-{short}-{factor}.ply")
                if not os.path.exists(level):
                    count = choose(path)["recommended"]["triangle_count"]
                    scree("simplify", path, "-n", max(4, round(factor * count)), "-o", level, "-q")
                files.append(os.path.basename(level))
            levels.append(files)
        study = os.path.join(folder, name + ".yaml")
        with open(study, "w", encoding="utf-8") as file:
            json.dump({"name": name, "replicates": 20, "base": {"preset": "small"}, "factors": {"shapes": levels}}, file)
        print(scree("study", study, "-o", os.path.join(folder, name)), flush=True)
        yield True


def main():
    what, words = sys.argv[2], sys.argv[3:]
    runs = {"scans": lambda: (check_scan(path) for path in words), "seeds": seeds, "noise": noise, "spacing": spacing,
            "moved": lambda: moved(words), "physics": lambda: physics(words[0], words[1:])}
    return 0 if all(list(runs[what]())) else 1


sys.exit(main())

#!/usr/bin/env python3
"""Twin experiments of scree calibrate: parameters are drawn from their ranges, "measurements" simulated with fresh seeds,
and the intervals that the calibration gives are compared with the truth. Prints a row a twin and the table of how many
intervals hold the truth. With --small heaps of 120 spheres.

usage: twins.py PROGRAM [--twins N] [--runs N] [--jobs N] [--angle-only] [--small] [--folder DIR]"""
import argparse
import json
import pathlib
import random
import subprocess
import tempfile

HEAP = """
time: 1.2
materials:
  grain: {{young: 5e5, density: 2500, restitution: 0.3, friction: 0.5, rolling_friction: 0.1}}
shapes: {{ball: {{sphere: {size}}}}}
geometry:
  plate: {{disc: {{radius: 0.12}}, material: grain}}
  cylinder: {{cylinder: {{radius: 0.03, length: 0.3}}, material: grain, motion: [{{translate: {{velocity: [0, 0, 0.25]}}, from: 0.4}}]}}
inlets:
  feed:
    cylinder: {{at: [0, 0, 0.1], axis: [0, 0, 1], radius: 0.029, length: 0.18}}
    shapes: ball
    count: {count}
    layers: {{packed: grid, above: 0.01}}
    velocity: [0, 0, -0.3]
domain: {{min: [-0.2, -0.2, -0.02], max: [0.2, 0.2, 0.6]}}
sensors: {{pile: {{pile: {{floor: 0}}}}}}
output: {{frames: 0, series: 0.2}}
"""
DRUM = """
time: 2.5
gravity: [0, 0, -9.81]
materials:
  grain: {{young: 5e5, density: 2500, restitution: 0.3, friction: 0.5, rolling_friction: 0.1}}
shapes: {{ball: {{sphere: {size}}}}}
geometry:
  shell: {{cylinder: {{radius: 0.04, axis: [0, 1, 0], length: 0}}, material: grain, motion: [{{rotate: {{axis: [0, 1, 0], speed: 3}}}}]}}
inlets: {{feed: {{box: {{min: [-0.02, 0, -0.02], max: [0.02, 0.03, 0.02]}}, shapes: ball, count: {drum}, rate: 2000}}}}
domain: {{min: [-0.05, 0, -0.05], max: [0.05, 0.03, 0.05], periodic: [y]}}
sensors: {{bed: {{slope: {{axis: [0, 1, 0]}}}}, torque: {{wall: shell}}}}
output: {{frames: 0, series: 0.1}}
"""
PARAMETERS = {"friction": ("materials.grain.friction", 0.1, 0.9), "rolling": ("materials.grain.rolling_friction", 0.01, 0.3),
              "restitution": ("materials.grain.restitution", 0.1, 0.8)}
ANSWERS = {"angle": ("heap", "pile.sector_deg", "", 0.5), "height": ("heap", "pile.height", "", 0.0005),
           "slope": ("drum", "bed.angle_deg", "from: 1", 0.5), "power": ("drum", "torque.power", "from: 1", 2e-5)}


def study(program, folder, scene, values, seed, answers):
    """One run of a scene at the truth: what is measured of it."""
    lines = "\n".join(f"  - {a}: {{{w}}}" if w else f"  - {a}" for _, a, w, _ in answers)
    settings = "".join(f"  {PARAMETERS[name][0]}: {value!r}\n" for name, value in values.items())
    (folder / "truth.yaml").write_text(f"base:\n  scene: {scene}\n{settings}seed: {seed}\nreplicates: 1\nanswers:\n{lines}\n")
    out = subprocess.run([program, "study", "truth.yaml", "-o", f"truth-{scene}", "-q", "--json"], cwd=folder, check=True,
                         stdout=subprocess.PIPE, text=True).stdout
    return [row["mean"] for row in json.loads(out)["points"][0]["answers"].values()]


def twin(program, folder, index, options):
    rng = random.Random(index)
    size = {"size": 0.008, "count": 120, "drum": 120} if options.small else {"size": 0.006, "count": 300, "drum": 400}
    answers = {name: row for name, row in ANSWERS.items() if not options.angle_only or name == "angle"}
    scenes = {row[0] for row in answers.values()}
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in (("heap", HEAP), ("drum", DRUM)):
        (folder / f"{name}.yaml").write_text(text.format(**size))
    names = ["friction", "rolling"] if options.angle_only else list(PARAMETERS)
    truth = {name: rng.uniform(*PARAMETERS[name][1:]) for name in names}
    measured = {}
    for scene in sorted(scenes):
        of_scene = [row for row in answers.values() if row[0] == scene]
        values = study(program, folder, f"{scene}.yaml", truth, 1000000 + index, of_scene)
        measured.update(zip([name for name, row in answers.items() if row[0] == scene], values))
    lines = ["seed: %d" % (1 + 10000 * index), "experiments:"]
    lines += [f"  {scene}: {{scene: {scene}.yaml}}" for scene in sorted(scenes)]
    lines += ["parameters:"] + [f"  {n}: {{field: {PARAMETERS[n][0]}, from: {PARAMETERS[n][1]}, to: {PARAMETERS[n][2]}}}" for n in names]
    lines += ["targets:"]
    for name, (scene, answer, window, uncertainty) in answers.items():
        if measured[name] is not None:
            lines.append(f"  {name}: {{experiment: {scene}, answer: {answer}, value: {measured[name]!r}, "
                         f"uncertainty: {uncertainty}{', ' + window if window else ''}}}")
    lines += [f"budget: {{runs: {options.runs}}}"]
    (folder / "calibrate.yaml").write_text("\n".join(lines) + "\n")
    out = subprocess.run([program, "calibrate", "calibrate.yaml", "-o", "out", "-q", "--json", "--jobs", str(options.jobs)], cwd=folder,
                         check=True, stdout=subprocess.PIPE, text=True).stdout
    return truth, json.loads(out)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--twins", type=int, default=20)
    parser.add_argument("--runs", type=int, default=60)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--angle-only", action="store_true")
    parser.add_argument("--small", action="store_true")
    parser.add_argument("--folder", type=pathlib.Path)
    options = parser.parse_args()
    folder = options.folder or pathlib.Path(tempfile.mkdtemp())
    program = str(pathlib.Path(options.program).resolve())
    held, said, share, count = {}, {}, 0.0, 0
    for index in range(options.twins):
        truth, result = twin(program, folder / f"twin-{index}", index, options)
        count += 1
        share += result["planning_seconds"] / result["seconds"]
        for p in result["parameters"]:
            inside = p["low"] <= truth[p["name"]] <= p["high"]
            held.setdefault(p["name"], []).append(inside)
            said.setdefault(p["name"], []).append(p["identified"])
            print(f"{index} {p['name']} truth {truth[p['name']]:.3f} interval {p['low']:.3f} to {p['high']:.3f} narrowed "
                  f"{p['narrowed']:.2f} {'held' if inside else 'MISSED'}", flush=True)
    for name, row in held.items():
        print(f"{name}: {sum(row)} of {count} intervals hold the truth; identified in {sum(said[name])}")
    print(f"planning took {100 * share / count:.2f} % of the runs' processor time")


main()

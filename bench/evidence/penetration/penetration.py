#!/usr/bin/env python3
"""A steel ball shot into a bed of spheres: scree beside LIGGGHTS from the same state, with the same law and step.

  penetration.py run FILE.csv        both codes; the height of the ball over time
  penetration.py compare FILE.csv    the largest difference over the deepest way

The bed is the middle half of the published one (|x| < 23.5 mm, 12,096 spheres), its stiffness a tenth, the ball begins
just above it with the speed of its fall. Environment: SCREE_EVIDENCE_DIR, LIGGGHTS (the program)."""
import pathlib
import shutil
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from common import WORK, Table, data, library, liggghts, needs, read  # noqa: E402

HALF, START, SPEED, EVERY = 0.0235, -0.0455, 5.2, 0.0005
COLUMNS = ["time", "scree_z", "liggghts_z"]


def bed():
    rows = [list(map(float, line.split())) for line in open(data("bulk") / "Penetration_25KParticles.txt") if line[:1] in " -0"]
    return [row[1:] for row in rows if len(row) == 4 and abs(row[1]) < HALF]


def with_scree(grains, folder):
    lines = ["shape,x,y,z,vz", *(f"grain,{x!r},{y!r},{z!r},0" for x, y, z in grains), f"ball,0,0,{START},-{SPEED}"]
    (folder / "bodies.csv").write_text("\n".join(lines) + "\n")
    shutil.copy(HERE / "scene.yaml", folder)
    scene, heights = library().Scene(str(folder / "scene.yaml")), []
    ball = len(grains)
    scene.every(EVERY, lambda s: heights.append(float(s.world.body(ball).position[2])))
    scene.run()
    return heights, scene.sensors["ledger"]


def with_liggghts(grains, folder):
    count = len(grains) + 1
    lines = [f"bed\n\n{count} atoms\n2 atom types\n", "-0.03 0.03 xlo xhi\n-0.04 0.04 ylo yhi\n-0.1 0.03 zlo zhi\n\nAtoms\n"]
    lines += [f"{i + 1} 1 0.002 2500 {x!r} {y!r} {z!r}" for i, (x, y, z) in enumerate(grains)]
    lines += [f"{count} 2 0.02 7200 0 0 {START}"]
    (folder / "bed.data").write_text("\n".join(lines) + "\n")
    liggghts(HERE / "liggghts.in", folder, {"BALL": count, "SPEED": -SPEED})
    # Its first row is that of the first interval.
    return [START, *(float(line.split()[1]) for line in open(folder / "heights.txt") if not line.startswith("#"))]


def run(path):
    needs("LIGGGHTS")
    folder, grains = WORK / "penetration", bed()
    folder.mkdir(parents=True, exist_ok=True)
    theirs = with_liggghts(grains, folder)
    begun = time.process_time()
    ours, ledger = with_scree(grains, folder)
    spent = time.process_time() - begun
    pathlib.Path(path).unlink(missing_ok=True)
    table = Table(path, COLUMNS, 1)
    for k, (a, b) in enumerate(zip(ours, theirs)):
        table.add(round(k * EVERY, 6), a, b)
    print(f"{len(grains)} grains; scree {spent:.0f} s of processor time, ledger {ledger:.1e}")


def compare(path):
    rows = [{name: float(value) for name, value in row.items()} for row in read(path)]
    way = rows[0]["scree_z"] - min(row["liggghts_z"] for row in rows)
    worst = max(rows, key=lambda row: abs(row["scree_z"] - row["liggghts_z"]))
    print(f"deepest way {1e3 * way:.2f} mm in LIGGGHTS, {1e3 * (rows[0]['scree_z'] - min(r['scree_z'] for r in rows)):.2f} mm in scree; "
          f"largest difference {1e3 * abs(worst['scree_z'] - worst['liggghts_z']):.3f} mm at {worst['time']} s, "
          f"{100 * abs(worst['scree_z'] - worst['liggghts_z']) / way:.2f} % of the way")


if __name__ == "__main__":
    if len(sys.argv) != 3 or sys.argv[1] not in ("run", "compare"):
        sys.exit(__doc__)
    {"run": run, "compare": compare}[sys.argv[1]](sys.argv[2])

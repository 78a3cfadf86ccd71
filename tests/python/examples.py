"""Runs the Python examples small, and looks at what they wrote.
usage: examples.py EXAMPLES_FOLDER"""
import json
import pathlib
import subprocess
import sys
import tempfile

examples, folder = pathlib.Path(sys.argv[1]), pathlib.Path(tempfile.mkdtemp())
said = subprocess.run([sys.executable, examples / "pile.py", folder, "sample:icosphere-1", "2", "40"], check=True,
                      stdout=subprocess.PIPE, text=True).stdout
assert "of 80 triangles" in said and "2 particles after" in said, said
pile = json.loads((folder / "pile/pile.json").read_text())
assert len(pile["bodies"]) == 2 and (folder / "pile/shape-0.stl").exists()
assert pile["shapes"][0]["triangle_count"] == 40, pile["shapes"]
assert (folder / "pile.pvd").exists() and (folder / "contacts-0005.vtp").exists()

# the importers' files; the programs themselves were run by hand (docs/reference/formats.md)
subprocess.run([sys.executable, examples / "pile_to_lammps.py", folder / "pile", folder / "lammps"], check=True)
data = (folder / "lammps/pile.data").read_text().splitlines()
assert data[2] == "2 atoms" and data[3] == "2 bodies", data[:6]
shape = pile["shapes"][0]
vertex_count = shape["triangle_count"] // 2 + 2
first = data.index("Bodies") + 2
value_count = 6 + 3 * vertex_count + 2 * (3 * vertex_count - 6) + 4 * shape["triangle_count"] + 1
assert data[first] == f"1 3 {value_count}", data[first]
assert data[first + 1] == f"{vertex_count} {3 * vertex_count - 6} {shape['triangle_count']}"
clumps = ("import sys, scree; w = scree.World(); m = w.add_material(); p = scree.Particle.clump_of(scree.load('sample:box'), 4); "
          "[w.add_body(p, m, position=(0, 0, z)) for z in (0.1, 0.3)]; w.export(sys.argv[1], unit='m')")
subprocess.run([sys.executable, "-c", clumps, folder / "clumps"], check=True)
subprocess.run([sys.executable, examples / "pile_to_liggghts.py", folder / "clumps", folder / "liggghts"], check=True)
spheres = [[float(x) for x in line.split()] for line in (folder / "liggghts/clump-0.txt").read_text().splitlines()]
reach = json.loads((folder / "clumps/pile.json").read_text())["shapes"][0]["bounding_radius"]
assert len(spheres) == 4 and all(sum(x * x for x in s[:3]) ** 0.5 + s[3] <= reach * (1 + 1e-6) for s in spheres)
refused = subprocess.run([sys.executable, examples / "pile_to_liggghts.py", folder / "pile", folder / "none"],
                         stderr=subprocess.PIPE, text=True)
assert refused.returncode == 1 and "is a mesh" in refused.stderr, refused.stderr
assert (folder / "liggghts/in.pile").read_text().count("insert/pack") == 2

# a heap, with fewer particles and shorter phases than the example takes by itself
short = ("import sys; sys.path.insert(0, sys.argv[1]); import heap; heap.main(sys.argv[2], fields={'particles': 6, "
         "'phases.pack_time': 0.3, 'phases.settle_time': 0.1, 'phases.lift_time': 0.2, 'phases.hold_time': 0.1}, triangles=40)")
for _ in range(2):  # the second time from what the first one left
    heap_said = subprocess.run([sys.executable, "-c", short, examples, folder / "heap"], check=True, stdout=subprocess.PIPE,
                               text=True).stdout
    assert "no heap: " in heap_said and "6 particles after" in heap_said and "highest centre" in heap_said, heap_said
assert "screeMOV" in (folder / "heap/motion.scree").read_bytes()[:8].decode()
result = json.loads((folder / "heap/result.json").read_text())
assert [shape["name"] for shape in result["shapes"]] == ["fp-1", "sp-1"] and result["piles"][0]["body_count"] == 6
assert "part-0" in (folder / "heap/report.html").read_text()
print(said)
print(heap_said)

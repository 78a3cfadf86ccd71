"""What is wrong in a call of `scree export --to` is told in one sentence, which names the place and, where a word is misspelt,
the one that may be meant: nothing is half written, nothing crashes.
usage: wrong.py PROGRAM"""
import pathlib
import re
import subprocess
import sys
import tempfile

program = pathlib.Path(sys.argv[1]).resolve()
folder = pathlib.Path(tempfile.mkdtemp())
clumps, both, meshes = ("liggghts", "pfc", "edem", "mfix"), ("lammps", "yade", "deme", "chrono"), ("rockable", "exadem", "mujoco", "blender")
codes = clumps + both + meshes
box = "sample:box-12"
(folder / "file").write_text("")
(folder / "spheres.csv").write_text("x,y,z,radius\n0,0,0,5\n6,0,0,5\n")
(folder / "empty.csv").write_text("")
(folder / "words.csv").write_text("x,y,z,radius\n0,0,zero,5\n")
corners = [(x, y, 0) for x in range(4) for y in range(4)]
cells = [(4 * i + j, 4 * i + j + 4, 4 * i + j + 5, 4 * i + j + 1) for i in range(3) for j in range(3)]
(folder / "sheet.off").write_text("OFF\n16 18 0\n" + "".join(f"{x} {y} {z}\n" for x, y, z in corners) +
                                  "".join(f"3 {a} {b} {c}\n3 {a} {c} {d}\n" for a, b, c, d in cells))
(folder / "not-a-number.off").write_text("OFF\n4 4 0\n0 0 nan\n9 0 0\n0 9 0\n0 0 9\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n")
calls = []  # (words, what the sentence must have)


def wrong(words, said):
    calls.append((words.split(), said))


for code in codes:
    at = len(code) // 2
    swapped = code[:at - 1] + code[at] + code[at - 1] + code[at + 1:]
    wrong(f"{box} --to {code[:-1] + code[-1] * 2} -o o", f"did you mean '{code}'")
    if swapped != code:
        wrong(f"{box} --to {swapped} -o o", f"did you mean '{code}'")
    wrong(f"sheet.off --to {code} -o o-{code}", "sheet.off")
    wrong(f"{box} --to {code} -o file/o", "file")
for code in clumps:
    wrong(f"{box} --to {code} --as mesh -o o", f"--to {code} takes clumps")
for code in meshes:
    wrong(f"{box} --to {code} --as clump -o o", f"--to {code} takes meshes")
    wrong(f"spheres.csv --to {code} -o o", f"--to {code} takes meshes")
for code in both:
    wrong(f"spheres.csv --to {code} --as mesh -o o", "spheres.csv is a clump")
    wrong(f"spheres.csv --to {code} -n 3 -o o", "--count is for a surface")
    wrong(f"{box} --to {code} --as clump -n 301 -o o", "300 spheres")
for option, value in (("-n", "0"), ("-n", "-3"), ("-n", "many"), ("--particles", "0"), ("--particles", "1.5"), ("--pieces", "0"),
                      ("--pieces", "2000"), ("--density", "0"), ("--density", "-1800"), ("--density", "1,8"), ("--young", "3"),
                      ("--young", "stiff"), ("-u", "parsec"), ("--as", "mehs"), ("--view", "points"), ("--resolution", "1")):
    wrong(f"{box} --to mujoco {option} {value} -o o", option if option.startswith("--") else "--")
wrong(f"{box} --to mmm -o o", "must be a unit")
wrong(f"{box} --to deme", "-o")
wrong(f"{box} sample:box --to deme -o o", "one surface")
wrong("missing.stl --to deme -o o", "missing.stl")
wrong("empty.csv --to deme -o o", "empty.csv")
wrong("words.csv --to lammps -o o", "words.csv")
wrong("not-a-number.off --to deme -o o", "not-a-number.off")
wrong("spheres.csv -o o", "--to")
wrong(f"{box} --to deme --centre -o o", "--centre")
wrong(f"{box} --as mesh -o o.stl", "--to")
wrong("sample:bocks --to deme -o o", "bocks")

first = subprocess.run([program, "export", box, "--to", "deme", "-q", "-o", "twice"], cwd=folder)
assert first.returncode == 0
wrong(f"{box} --to deme -o twice", "exists already")

failed = 0
for words, said in calls:
    before = {path for path in folder.rglob("*") if path.is_file()}
    ran = subprocess.run([program, "export", *words], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    sentence = ran.stderr.splitlines()[0] if ran.stderr else ""
    more = [line for line in ran.stderr.splitlines()[1:] if not line.startswith(("usage: ", "`scree help"))]
    left = {path for path in folder.rglob("*") if path.is_file()} - before
    wanted = ran.returncode in (1, 2) and sentence.startswith("scree") and re.search(said, sentence) and not more and not left
    if not wanted or ran.stdout:
        failed += 1
        print(f"FAILED: scree export {' '.join(words)}: {ran.returncode}, wanted '{said}', left {left}\n{ran.stderr}{ran.stdout}")
print(f"{len(calls)} wrong uses, {failed} not told as they should be")
assert len(calls) >= 60
sys.exit(failed > 0)

"""Runs the verbs with --json and compares the fields they print with docs/reference/formats.md: each field printed must be
in the verb's table, in the common one, or a member of a structure that the page names, and each field in a table must be
printed. `scree export` writes its JSON as files.
usage: json_fields.py PROGRAM FORMATS.MD WORLD_WRITER"""
import glob
import itertools
import json
import os
import re
import subprocess
import sys
import tempfile

program, world_writer, document = sys.argv[1], sys.argv[3], open(sys.argv[2], encoding="utf-8").read()
HEADERS = os.path.join(os.path.dirname(os.path.abspath(sys.argv[2])), "..", "..", "include", "scree")
os.chdir(tempfile.mkdtemp())
with open("open.off", "w") as file:  # a tetrahedron without one facet: repair has something to do
    file.write("OFF 4 3 0\n0 0 0\n9 0 0\n0 9 0\n0 0 9\n3 0 2 1\n3 0 1 3\n3 0 3 2\n")
BALL, SOLID = "sample:icosphere-3", "sample:box-12"
VERBS = {  # heading: calls that together print every field
    "scree choose": [["choose", BALL, "open.off", "--errors"]],
    "scree clump": [["clump", SOLID, "--max", "2"]],
    "scree curve": [["curve", BALL, "--distance", "--grid", "1e-5:1e-1:1"]],
    "scree measure": [["measure", SOLID]],
    "scree distance": [["distance", SOLID, BALL, "--points", "100"]],
    "scree run, repose, drop and pile": [["repose", SOLID, "--particles", "2", "--pack-time", "0.02", "--settle-time",
                                          "0.01", "--lift-time", "0.01", "--hold-time", "0.01", "-j", "1", "-o", "heap"],
                                         ["run", "-o", "heap", "--resume", "--change", "gravity=5"],
                                         ["run", "hopper.yaml", "--set", "time=1.2", "--set", "inlets.feed.count=9", "--set",
                                          "materials.grain.young=1e4"]],
    "scree pile of a scan, an outline or a picture": [["pile", SOLID]],
    "scree check and scree repair": [["check", SOLID, "missing.stl"], ["repair", "open.off", "-o", "r.stl"]],
}


def expand(text):
    """a.{b,c} to a.b and a.c"""
    parts = [p[1:-1].split(",") if p.startswith("{") else [p] for p in re.split(r"(\{[^}]*\})", text)]
    return {"".join(words) for words in itertools.product(*parts)}


def documented(text):
    """First column of the tables."""
    fields = set()
    for row in re.findall(r"^\| (`.*?) \|", text, re.MULTILINE):
        for name in re.findall(r"`([^`]+)`", row):
            fields |= expand(name)
    return fields


def members():
    """Those of the public structures; of an array by kind the kinds' names in JSON."""
    found, counts = {}, {}
    for path in glob.glob(os.path.join(HEADERS, "*.h")):
        text = re.sub(r"/\*.*?\*/", "", open(path, encoding="utf-8").read(), flags=re.DOTALL)
        for body, name in re.findall(r"typedef struct scree_\w+ \{([^{}]*)\} (scree_\w+);", text):
            found[name] = {field for line in body.split(";") for field in re.findall(r"(\w+)(?:\[[^]]*\])*\s*(?=,|$)", line.strip())}
        for kind, rows in re.findall(r"#define SCREE_(DEFECT|REPAIR)_LIST\(X\)(.*?[^\\])\n", text, re.DOTALL):
            counts[{"DEFECT": "defects", "REPAIR": "done"}[kind]] = re.findall(r'X\(\w+,\s*\\?\s*"(\w+)"', rows)
    return {name: {f"{field}.{key}" if field in counts else field for field in fields for key in counts.get(field, [""])} for name, fields in found.items()}


def allowed(text):
    """Where a line names the structures: their fields."""
    fields = set()
    for line in re.findall(r"^Members of .*(?:\n.+)*", text, re.MULTILINE):
        for prefix, name in re.findall(r"(?:`([\w.\[\]]+\.)` as )?`(scree_\w+)`", line):
            fields |= {prefix + field for field in MEMBERS[name]}
    return fields


def printed(value, path=""):
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from printed(inner, f"{path}.{key}" if path else key)
    elif isinstance(value, list) and all(isinstance(inner, dict) for inner in value):
        for inner in value:
            yield from printed(inner, path + "[]")
    else:
        yield path


def fields_of(text):
    data = json.loads(text)
    return {field for one in (data if isinstance(data, list) else [data]) for field in printed(one)}


def compare(heading, found):
    for field in sorted(found - tables[heading] - common - named[heading]):
        print(f"{heading}: {field} is printed, but not in the table")
    for field in sorted(tables[heading] - found):
        print(f"{heading}: {field} is in the table, but not printed")
    print(f"{heading}: {len(found)} fields")
    return not tables[heading] - common <= found - common <= tables[heading] | named[heading]


MEMBERS = members()
section = document.split("\n## JSON\n")[1].split("\n## ")[0].split("\n### ")
tables = {part.split("\n")[0]: documented(part) for part in section[1:]}
named = {part.split("\n")[0]: allowed(part) for part in section[1:]}
common, failed = documented(section[0]), False
assert len(common) == 6
with open("hopper.yaml", "wb") as file:
    file.write(subprocess.run([program, "run", "--template", "hopper"], stdout=subprocess.PIPE, check=True).stdout)
for heading, calls in VERBS.items():
    found = set()
    for call in calls:
        found |= fields_of(subprocess.run([program, call[0], "--json", "-q", *call[1:]], stdout=subprocess.PIPE,
                                          stderr=subprocess.DEVNULL, check=False).stdout)
    failed |= compare(heading, found)
subprocess.run([program, "export", SOLID, "-o", "solid.stl", "-q"], check=True)
failed |= compare("scree export of a surface", fields_of(open("solid.json", "rb").read()))
subprocess.run([program, "drop", "sphere:20mm=2", "--time", "0.01", "--no-picture", "-o", "pour", "-q"], check=True,
               stdout=subprocess.DEVNULL)
poured = fields_of(open("pour/result.json", "rb").read())
unknown = poured - tables["scree run, repose, drop and pile"] - common - {"piles"}
print("\n".join(f"not in the table: {field}" for field in sorted(unknown)))
failed |= bool(unknown)
subprocess.run([program, "simplify", SOLID, "-n", "12", "--density", "3", "-o", "level.stl", "-q"], check=True)
subprocess.run([program, "choose", SOLID, BALL, "--density", "3", "-o", "chosen", "-q"], check=True, stdout=subprocess.DEVNULL)
for path in ("level.json", "chosen/box-12.mass.json", "chosen/set/icosphere-3.mass.json"):
    text = open(path, "rb").read()
    failed |= compare("scree export of a surface", fields_of(text))
    weighed = json.loads(text)
    assert weighed["density"] == 3 and abs(weighed["mass"] / (3 * weighed["volume"]) - 1) < 1e-12, path
    assert os.path.exists(os.path.join(os.path.dirname(path), weighed["mesh_file"])), path
subprocess.run([world_writer, "."], stdout=subprocess.DEVNULL, check=True)
subprocess.run([program, "export", "world.scree", "-o", "pile"], check=True)
failed |= compare("scree export of a checkpoint", fields_of(open("pile/pile.json", "rb").read()))
sys.exit(failed)

#!/usr/bin/env python3
"""Every field of a scene that the program reads (the lists of src/scene/plan.h) stands in docs/reference/scenes.md, and
so does every template. usage: scene_fields.py ROOT PROGRAM"""
import re
import subprocess
import sys

root, program = sys.argv[1:]


def read(path):
    with open(f"{root}/{path}", encoding="utf-8") as file:
        return file.read()


page = read("docs/reference/scenes.md")
named = set(re.findall(r"[\w-]+", " ".join(re.findall(r"`[^`\n]+`", page))))
tables = re.findall(r"^#define SCREE_PLAN_(\w+)\(ROW, T\) *\\\n(.*?)^\S", read("src/scene/plan.h"), re.MULTILINE | re.DOTALL)
missing = [f"{record}: {key}" for record, body in tables
           for kind, key in re.findall(r'ROW\(T, ([A-Z]+),\s*(?:\\\n\s*)?"?(\w+)"?,', body) if kind != "OWN" and key not in named]
said = subprocess.run([program, "run", "--template", "-"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
templates = re.search(r"there are (.*)", said.stderr)[1].split(", ")
for name in templates:
    for place in ("docs/reference/scenes.md", "docs/tutorials/own-machine.md"):
        if not re.search(rf"`{name}`|--template {name}\b", read(place)):
            missing.append(f"{place}: template {name}")
assert len(tables) > 20 and len(templates) > 5, "the tables are not where they are looked for"
print("\n".join(f"not documented: {m}" for m in missing) or f"{len(tables)} records, {len(templates)} templates")
sys.exit(bool(missing))

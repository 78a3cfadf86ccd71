#!/usr/bin/env python3
"""Every field of a scene that the program reads (the tables of src/scene/plan*.c) stands in docs/reference/scenes.md, and
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
source = "".join(read(f"src/scene/{name}.c") for name in ("plan", "plan_sensors", "plan_parts", "plan_forces", "sizes"))
tables = re.findall(r"^static const scree_field (\w+)_fields\[\] = \{\n(.*?)^\};", source, re.MULTILINE | re.DOTALL)
missing = [f"{record}: {key}" for record, body in tables for key in re.findall(r'^ +(?:\{"|[A-Z]+\()\s*(\w+)"?,', body, re.MULTILINE)
           if key not in named]
said = subprocess.run([program, "run", "--template", "-"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
templates = re.search(r"there are (.*)", said.stderr)[1].split(", ")
for name in templates:
    for place in ("docs/reference/scenes.md", "docs/tutorials/own-machine.md"):
        if not re.search(rf"`{name}`|--template {name}\b", read(place)):
            missing.append(f"{place}: template {name}")
assert len(tables) > 20 and len(templates) > 5, "the tables are not where they are looked for"
print("\n".join(f"not documented: {m}" for m in missing) or f"{len(tables)} records, {len(templates)} templates")
sys.exit(bool(missing))

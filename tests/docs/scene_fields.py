#!/usr/bin/env python3
"""Every field of a scene that the program reads (the lists of src/scene/plan.h and of its kinds) stands in docs/reference/scenes.md, and
so does every template. usage: scene_fields.py ROOT PROGRAM"""
import glob
import re
import subprocess
import sys

root, program = sys.argv[1:]


def read(path):
    with open(f"{root}/{path}", encoding="utf-8") as file:
        return file.read()


page = read("docs/reference/scenes.md")
named = set(re.findall(r"[\w-]+", " ".join(re.findall(r"`[^`\n]+`", page))))
lists = "\n".join(read(path) for path in ["src/scene/plan.h"] + sorted(glob.glob("src/scene/*/*.[ch]", root_dir=root)))
tables = re.findall(r"^#define SCREE_(?:PLAN_)?(\w+)\(ROW, T\) *\\?\s(.*?)^\S", lists, re.MULTILINE | re.DOTALL)
missing = [f"{record}: {key}" for record, body in tables
           for kind, key in re.findall(r'ROW\(T, ([A-Z]+),\s*(?:\\\n\s*)?"?(\w+)"?,', body) if kind != "OWN" and key not in named]
said = subprocess.run([program, "run", "--template", "-"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
templates = re.search(r"there are (.*)", said.stderr)[1].split(", ")
for name in templates:
    if f"`{name}`" not in page:
        missing.append(f"template {name}")
assert len(tables) > 20 and len(templates) > 5, "the tables are not where they are looked for"
print("\n".join(f"not documented: {m}" for m in missing) or f"{len(tables)} records, {len(templates)} templates")
sys.exit(bool(missing))

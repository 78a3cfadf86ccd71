#!/usr/bin/env python3
"""Every link between the pages and every mention of a page in the sources leads somewhere; every page of docs/ can be
reached from its part's index; the version is the same everywhere. usage: links.py ROOT"""
import os
import re
import subprocess
import sys

root = sys.argv[1]
try:
    files = subprocess.run(["git", "-C", root, "ls-files", "-co", "--exclude-standard"], stdout=subprocess.PIPE, text=True, check=True).stdout.split("\n")
except (OSError, subprocess.CalledProcessError):
    print("no git: the files are not known")
    sys.exit(77)
files = [f for f in files if f and os.path.isfile(os.path.join(root, f))]
pages = [f for f in files if f.endswith(".md") and not f.startswith("web/")]
wrong = []


def read(path):
    with open(os.path.join(root, path), encoding="utf-8", errors="replace") as file:
        return file.read()


def anchors(page):
    """As GitHub makes them of headings."""
    text = re.sub(r"^```.*?^```", "", read(page), flags=re.MULTILINE | re.DOTALL)
    return {re.sub(r"[^\w\- ]", "", h.lower().replace("`", "")).replace(" ", "-") for h in re.findall(r"^#+ (.*)", text, re.MULTILINE)}


linked = set()
for page in pages:
    text = re.sub(r"^```.*?^```", "", read(page), flags=re.MULTILINE | re.DOTALL)
    for link in re.findall(r"\]\(([^)\s]+)\)", text):
        if re.match(r"[a-z]+:", link):
            continue
        name, _, anchor = link.partition("#")
        target = os.path.normpath(os.path.join(os.path.dirname(page), name)) if name else page
        linked.add((page, target))
        if not os.path.exists(os.path.join(root, target)):
            wrong.append(f"{page}: {link} is not there")
        elif anchor and anchor not in anchors(target):
            wrong.append(f"{page}: {link} has no such heading")

for page in pages:
    part = os.path.dirname(page)
    if part.startswith("docs") and os.path.basename(page) != "index.md":
        index = f"{part}/index.md"
        if (index, page) not in linked:
            wrong.append(f"{page}: {index} does not lead there")

for file in files:
    if file.endswith((".png", ".inc", ".json", ".svg")) or file.startswith(("tests/fuzz/corpus", "bench/results", "CHANGELOG")):
        continue
    for name in set(re.findall(r"\bdocs/[\w/-]+\.md\b", read(file))):
        if not os.path.exists(os.path.join(root, name)):
            wrong.append(f"{file}: {name} is not there")

version = read("VERSION").strip()
for file, line in (("CITATION.cff", f"version: {version}"), ("CHANGELOG.md", f"## [{version}]")):
    if line not in read(file):
        wrong.append(f"{file}: has no line {line}")

print("\n".join(wrong) or f"{len(pages)} pages")
sys.exit(bool(wrong))

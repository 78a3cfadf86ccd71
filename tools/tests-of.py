#!/usr/bin/env python3
"""The tests of a folder of src, one a line as ctest names them: those that include its internal headers, and those that
call the public functions of it and of no layer after it; of src/cli the scripts. usage: tools/tests-of.py src/world"""
import glob
import os
import re
import sys

# Public headers in the order of the layers, and the folder of each.
LAYERS = {"base": "base", "mesh": "mesh", "measure": "mesh/measure", "check": "mesh/repair", "simplify": "simplify",
          "fidelity": "choice", "choice": "choice", "sample": "sample", "particle": "particle", "clump": "clump",
          "world": "world", "heap": "heap", "scene": "scene", "study": "study", "calibrate": "calibrate", "report": "report"}


def text_of(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def folders_of(source, functions):
    """Folders of src that a test is of."""
    text = text_of(source)
    folders = {folder for folder in re.findall(r'#include "([a-z/]+)/[a-z0-9_]+\.h"', text) if folder not in ("base", "support", "scree")}
    called = set(re.findall(r"\bscree_[a-z0-9_]+(?=\()", text))
    last = [folder for header, folder in LAYERS.items() if called & functions[header]]
    return folders | set(last[-1:] or ["base"])


def main():
    root = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
    wanted = os.path.relpath(os.path.join(root, sys.argv[1]), os.path.join(root, "src"))
    if not os.path.isdir(os.path.join(root, "src", wanted)):
        sys.exit(f"tests-of.py: {sys.argv[1]}: no folder of src")
    if wanted == "cli":
        print("\n".join(sorted("cli." + os.path.basename(path)[:-3] for path in glob.glob(os.path.join(root, "tests/cli/*.sh")) if not path.endswith("/run.sh"))))
        return
    functions = {name: set(re.findall(r"\bscree_[a-z0-9_]+(?=\()", text_of(os.path.join(root, "include/scree", name + ".h")))) for name in LAYERS}
    for kind in ("unit", "law", "golden"):
        for source in sorted(glob.glob(os.path.join(root, "tests", kind, "*.c"))):
            folders = folders_of(source, functions)
            if any(folder == wanted or folder.startswith(wanted + "/") for folder in folders):
                print(f"{kind}.{os.path.basename(source)[:-2]}")


main()

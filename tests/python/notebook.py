"""Runs the cells of a notebook in their order; every value that a cell ends with is shown.
usage: notebook.py NOTEBOOK      Exits 77 where there is no numpy."""
import ast
import importlib.util
import json
import os
import pathlib
import sys
import tempfile

if not importlib.util.find_spec("numpy"):
    print("skipped: numpy is not installed (Debian: python3-numpy)")
    sys.exit(77)
cells = [cell for cell in json.loads(pathlib.Path(sys.argv[1]).read_text(encoding="utf-8"))["cells"]
         if cell["cell_type"] == "code"]
os.chdir(tempfile.mkdtemp())
names, shown = {}, 0
for cell in cells:
    assert not cell["outputs"], "outputs are not kept in the repository"
    tree = ast.parse("".join(cell["source"]))
    last = ast.Expression(tree.body.pop().value) if isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, sys.argv[1], "exec"), names)
    if last:
        value = eval(compile(last, sys.argv[1], "eval"), names)
        shown += len(value._repr_html_() if hasattr(value, "_repr_html_") else repr(value)) > 20
assert shown == len(cells), f"{shown} of {len(cells)} cells show something"

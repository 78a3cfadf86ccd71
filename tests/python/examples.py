"""Runs the Python examples small, and looks at what they wrote.
usage: examples.py EXAMPLES_FOLDER"""
import json
import pathlib
import subprocess
import sys
import tempfile

examples, folder = pathlib.Path(sys.argv[1]), pathlib.Path(tempfile.mkdtemp())
said = subprocess.run([sys.executable, examples / "pile.py", folder, "sample:icosphere-3", "2"], check=True,
                      stdout=subprocess.PIPE, text=True).stdout
assert "of 1280 triangles" in said and "2 particles after" in said, said
pile = json.loads((folder / "pile/pile.json").read_text())
assert len(pile["bodies"]) == 2 and (folder / "pile/shape-0.stl").exists()
assert (folder / "pile.pvd").exists() and (folder / "contacts-0005.vtp").exists()
print(said)

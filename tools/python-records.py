"""Writes python/scree/_records.py, the results of the library as classes with types, by the public headers.
usage: python-records.py [--check]"""
import ctypes
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "python/scree"))
from _headers import Enum, Headers  # noqa: E402

STRUCTS = ["checksum", "cut_plane", "check", "repair_report", "pick", "choice_level", "noise", "clump_gap", "clump", "measures", "topology",
           "deviation", "distance", "descriptors", "wall_mending", "particle_measures", "exported", "code_written", "curve_facts",
           "level", "observation", "material_contact"]
OTHER = {"check": {"defects": "dict[str, int | None]", "volume": "float | None"},
         "repair_report": {"before": "Check", "after": "Check", "done": "dict[str, int]"},
         "choice_level": {"errors": "dict[str, float]"}}


def name_of(struct):
    return "".join(part.capitalize() for part in struct.split("_"))


def type_of(kind):
    if issubclass(kind, ctypes.Structure):
        return name_of(kind.__name__[len("scree_"):])
    if issubclass(kind, Enum) or kind is ctypes.c_char_p:
        return "str"
    if issubclass(kind, ctypes.Array):
        return "str" if kind._type_ is ctypes.c_char else "Any"
    if kind is ctypes.c_bool:
        return "bool"
    return "float" if kind in (ctypes.c_double, ctypes.c_float) else "int"


headers = Headers(ROOT / "include/scree")
lines = ['"""Results by name and type: made by tools/python-records.py of the public headers, which say what each value is. Arrays',
         'are numpy arrays where numpy is there, else lists."""', "from __future__ import annotations", "", "from typing import Any",
         "", "from ._values import Fields, KINDS", ""]
for struct in STRUCTS:
    lines += ["", f"class {name_of(struct)}(Fields):"]
    for field, kind in headers.type(f"scree_{struct}")._fields_:
        if kind is ctypes.c_void_p or issubclass(kind, (ctypes._Pointer, ctypes._CFuncPtr)):
            continue
        lines.append(f"    {field}: {OTHER.get(struct, {}).get(field) or type_of(kind)}")
    lines.append("")
lines += ["", "KINDS.update({"] + [f'    "scree_{s}": {name_of(s)},' for s in STRUCTS] + ["})"]
text, path = "\n".join(lines) + "\n", ROOT / "python/scree/_records.py"
if "--check" not in sys.argv:
    path.write_text(text, encoding="utf-8")
elif path.read_text(encoding="utf-8") != text:
    sys.exit("python/scree/_records.py is not that of the headers: run tools/python-records.py")

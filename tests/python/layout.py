"""Has the C compiler say the size and offset of every struct and field that python/scree/_library.py declares, and
the value of every enum that it relies on, and compares.
usage: layout.py COMPILER INCLUDE_DIR (with the module on PYTHONPATH and SCREE_LIBRARY set)"""
import ctypes
import pathlib
import subprocess
import sys
import tempfile

from scree import _library as c

structs = {name: kind for name, kind in vars(c).items()
           if isinstance(kind, type) and issubclass(kind, ctypes.Structure) and name.startswith("scree_")}
enums = {f"SCREE_{name}": i for i, name in enumerate(c.STATUSES)}
for prefix, words in (("METHOD", c.METHODS), ("REFERENCE", c.REFERENCES), ("PARTICLE", c.PARTICLE_KINDS),
                      ("LAW", c.LAWS), ("WALL", c.WALL_KINDS), ("VIEW", c.VIEWS)):
    enums |= {f"SCREE_{prefix}_{word.upper()}": i for i, word in enumerate(words)}
for i, word in enumerate(("AREA", "VOLUME", "HAUSDORFF", "MEAN", "INERTIA", "WIDTHS")):
    enums[f"SCREE_ERROR_{word}"] = i
enums |= {"SCREE_STATUS_COUNT": len(c.STATUSES), "SCREE_SHAPE_ERROR_COUNT": len(c.SHAPE_ERRORS),
          "SCREE_DEFECT_COUNT": c.DEFECT_COUNT, "SCREE_REPAIR_ACTION_COUNT": c.REPAIR_ACTION_COUNT,
          "SCREE_VIEW_COUNT": len(c.VIEWS)}

expected, lines = {}, []
for name, kind in structs.items():
    lines.append(f'printf("{name} %zu\\n", sizeof({name}));')
    expected[name] = [ctypes.sizeof(kind)]
    for field, _ in kind._fields_:
        lines.append(f'printf("{name}.{field} %zu %zu\\n", offsetof({name}, {field}), sizeof((({name} *)0)->{field}));')
        expected[f"{name}.{field}"] = [getattr(kind, field).offset, getattr(kind, field).size]
for name, value in enums.items():
    lines.append(f'printf("{name} %d\\n", (int){name});')
    expected[name] = [value]

folder = pathlib.Path(tempfile.mkdtemp())
(folder / "layout.c").write_text('#include "scree.h"\nint main(void) {\n' + "\n".join(lines) + "\nreturn 0;\n}\n")
subprocess.run([sys.argv[1], "-std=c17", "-I", sys.argv[2], str(folder / "layout.c"), "-o", str(folder / "layout")],
               check=True)
output = subprocess.run([str(folder / "layout")], check=True, stdout=subprocess.PIPE, text=True).stdout
got = {line.split()[0]: [int(word) for word in line.split()[1:]] for line in output.splitlines()}
bad = [name for name in expected if got.get(name) != expected[name]]
for name in bad:
    print(f"{name}: C has {got.get(name)}, python/scree/_library.py {expected[name]} (size, or offset and size)")
print(f"{len(structs)} structs, {len(expected)} sizes, offsets and enum values; {len(bad)} differ")
sys.exit(bool(bad))

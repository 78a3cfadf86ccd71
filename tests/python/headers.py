"""What the module reads in the public headers, against a C compiler: every size and offset of structs, every value of
enums, the type of every function; and the library has all of these functions.
usage: headers.py COMPILER INCLUDE_DIR (with the module on PYTHONPATH and SCREE_LIBRARY set)"""
import ctypes
import pathlib
import re
import subprocess
import sys
import tempfile

from scree._headers import Enum, Headers
from scree._library import lib

compiler, include = sys.argv[1], pathlib.Path(sys.argv[2])
folder = pathlib.Path(tempfile.mkdtemp())


def compiled(name, text, *options):
    (folder / f"{name}.c").write_text('#include "scree.h"\n' + text)
    subprocess.run([compiler, "-std=c17", "-I", str(include), str(folder / f"{name}.c"), *options], check=True)


def parameter(declared):
    """As C would have it."""
    return (f"{'const ' * declared.const}{declared.base}{declared.pointers} {declared.name}"
            + "".join(f"[{length}]" for length in declared.lengths))


def prototype(headers, name):
    result, parameters = headers.signature(name)
    result = f"{'const ' * result.const}{result.base}{result.pointers} "
    return f"{result}{name}({', '.join(map(parameter, parameters)) or 'void'});"


def layout(headers):
    """Lines of C that print sizes, offsets and values, and what they are to print."""
    expected, lines = {}, []
    for name in headers.structs:
        kind = headers.type(name)
        lines.append(f'printf("{name} %zu\\n", sizeof({name}));')
        expected[name] = [ctypes.sizeof(kind)]
        for field, _ in kind._fields_:
            lines.append(f'printf("{name}.{field} %zu %zu\\n", offsetof({name}, {field}), sizeof((({name} *)0)->{field}));')
            expected[f"{name}.{field}"] = [getattr(kind, field).offset, getattr(kind, field).size]
    for name, value in headers.constants.items():
        lines.append(f'printf("{name} %d\\n", (int){name});')
        expected[name] = [value]
    return expected, lines


headers = lib.headers
text = re.sub(r"/\*.*?\*/", "", "".join(path.read_text() for path in sorted((include / "scree").glob("*.h"))), flags=re.S)
declared = {match[1] for match in re.finditer(r"SCREE_API\s[^(]*?(\w+)\(", re.sub(r"#.*", "", text))}
assert declared == set(headers.functions) and len(declared) > 200, declared ^ set(headers.functions)
missing = [name for name in headers.functions if not hasattr(lib.c, name)]
assert not missing, f"not in the library: {missing}"
for name in headers.functions:
    getattr(lib, name[len("scree_"):])  # every argument has a type for ctypes
compiled("functions", "\n".join(prototype(headers, name) for name in headers.functions), "-fsyntax-only")

expected, lines = layout(headers)
compiled("layout", "#include <stdio.h>\nint main(void) {\n" + "\n".join(lines) + "\nreturn 0;\n}\n", "-o", str(folder / "layout"))
output = subprocess.run([str(folder / "layout")], check=True, stdout=subprocess.PIPE, text=True).stdout
got = {line.split()[0]: [int(word) for word in line.split()[1:]] for line in output.splitlines()}
bad = [name for name in expected if got.get(name) != expected[name]]
for name in bad:
    print(f"{name}: C has {got.get(name)}, the module {expected[name]} (size, or offset and size)")

for name in headers.enums:
    assert issubclass(headers.type(name), Enum) and all(re.fullmatch(r"\w+", word) for word in headers.type(name).words), name
# what the module cannot read it says, and never passes over
for wrong in ("typedef union scree_u { int a; } scree_u;", "typedef struct scree_s { unsigned a : 1; } scree_s;",
              "SCREE_API void scree_f(unknown_type a);", "extern int scree_global;",
              "typedef struct scree_s { int a; struct { int c; } b; } scree_s;", "SCREE_API void scree_f(int);"):
    (folder / "wrong").mkdir(exist_ok=True)
    (folder / "wrong/wrong.h").write_text(wrong)
    try:
        read = Headers(folder / "wrong")
        for name in read.structs:
            read.type(name)
        for name in read.functions:
            result, parameters = read.signature(name)
            [read.of(parameter, parameter=True) for parameter in parameters]
    except SyntaxError:
        continue
    sys.exit(f"read without complaint: {wrong}")
print(f"{len(headers.structs)} structs, {len(headers.functions)} functions, {len(expected)} sizes, offsets and values; "
      f"{len(bad)} differ")
sys.exit(bool(bad))

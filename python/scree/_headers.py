"""The public headers as ctypes: types and functions by name, made when they are first asked for.

The headers keep to a small part of C. Each declaration is one of: a struct, an opaque struct, an enum (by a list macro
too), a type of functions, a function. Whatever else stands in them is a SyntaxError; tests/python/headers.py has a C
compiler compare all that is read here."""
import ctypes
import re
import threading

NUMBERS = {"bool": ctypes.c_bool, "char": ctypes.c_char, "int": ctypes.c_int, "long long": ctypes.c_longlong,
           "float": ctypes.c_float, "double": ctypes.c_double, "size_t": ctypes.c_size_t, "uint8_t": ctypes.c_uint8,
           "uint32_t": ctypes.c_uint32, "uint64_t": ctypes.c_uint64, "int64_t": ctypes.c_int64}
NAMED = re.compile(r"(const )?((?:long )?\w+)((?: |\*|const\b)+)(\w+)((?: ?\[[\w +]+\])*)")
FURTHER = re.compile(r"((?: |\*|const\b)*)(\w+)((?: ?\[[\w +]+\])*)")
CALLED = re.compile(r"(.+?) ?\(\*(\w+)\) ?\((.*)\)")


class Enum(ctypes.c_int):
    """Of one enumeration; `words` are its values in lower case without what all of them begin with."""
    words = ()


class Declared:
    """A parameter, a field or a result: its name, the name of its type, the stars behind that, lengths of an array; of a
    pointer to functions their result and parameters."""

    def __init__(self, name, base, const=False, pointers="", lengths=(), call=None):
        self.name, self.base, self.const, self.pointers, self.lengths, self.call = name, base, const, pointers, lengths, call
        self.stars = pointers.count("*")


class Headers:
    def __init__(self, folder):
        text = "".join(path.read_text(encoding="utf-8") for path in sorted(folder.glob("*.h")))
        if not text:
            raise FileNotFoundError(f"no headers in {folder}")
        self.structs, self.opaque, self.enums, self.callbacks, self.functions = {}, set(), {}, {}, {}
        self.constants, self._types = {}, dict(NUMBERS)
        self.making = threading.RLock()  # what is made is made once, whichever thread asks first
        for statement in _statements(text):
            self._take(" ".join(statement.split()))
        self.opaque -= set(self.structs)

    def _take(self, said):
        if match := re.fullmatch(r"typedef struct (\w+) \{(.*)\} \1;", said):
            self.structs[match[1]] = match[2]
        elif match := re.fullmatch(r"typedef struct (\w+) \1;", said):
            self.opaque.add(match[1])
        elif match := re.fullmatch(r"(?:typedef )?enum (\w+ )?\{(.*)\}(?: \w+)?;", said):
            self._take_enum((match[1] or "").strip(), [item.strip() for item in match[2].split(",") if item.strip()])
        elif match := re.fullmatch(r"(typedef|SCREE_API) (.*?)(\w+)\((.*)\);", said):
            (self.callbacks if match[1] == "typedef" else self.functions)[match[3]] = match[2], match[4]
        else:
            raise SyntaxError(f"neither a type nor a function: {said}")

    def _take_enum(self, name, items):
        value = -1
        for i, item in enumerate(items):
            key, _, given = (part.strip() for part in item.partition("="))
            value = int(given, 0) if given else value + 1
            items[i], self.constants[key] = key, value
        if name:
            words = items[:-1] if items[-1].endswith("_COUNT") else items
            while len(words) > 1 and len({word.partition("_")[0] for word in words}) == 1:
                words = [word.partition("_")[2] for word in words]
            self.enums[name] = [word.lower() for word in words]

    def declared(self, said):
        """What is declared in one go: of "double *a, b[3]" two."""
        said = said.strip()
        if match := CALLED.fullmatch(said):
            return [Declared(match[2], "", call=(match[1] + " ", match[3]))]
        if not (match := NAMED.fullmatch(said.partition(",")[0])):
            raise SyntaxError(f"no declaration: {said}")
        const, base = bool(match[1]), match[2]
        parts = [match.group(3, 4, 5)]
        for further in said.split(",")[1:]:
            if not (match := FURTHER.fullmatch(further.strip())):
                raise SyntaxError(f"no declaration: {said}")
            parts.append(match.groups())
        return [Declared(name, base, const, pointers, self._lengths(lengths)) for pointers, name, lengths in parts]

    def _lengths(self, text):
        return tuple(sum(self.constants[term] if term in self.constants else int(term) for term in re.findall(r"\w+", length))
                     for length in re.findall(r"\[(.*?)\]", text))

    def signature(self, name):
        """(result, parameters) of a function."""
        result, parameters = self.functions[name]
        return self._signature(result, parameters)

    def _signature(self, result, parameters):
        parts = [] if parameters.strip() == "void" else parameters.split(",")
        return self.declared(result + "result")[0], [self.declared(part)[0] for part in parts]

    def type(self, name):
        """The ctypes type of this name."""
        with self.making:
            if name not in self._types:
                self._make(name)
            return self._types[name]

    def _make(self, name):
        if name in self.enums:
            self._types[name] = type(name, (Enum,), {"words": tuple(self.enums[name])})
        elif name in self.structs:
            self._types[name] = made = type(name, (ctypes.Structure,), {})  # a field may point to its own kind
            made._fields_ = [(field.name, self.of(field)) for said in self.structs[name].split(";") if said.strip()
                             for field in self.declared(said)]
        elif name in self.callbacks:
            self._types[name] = self._callback(*self.callbacks[name])
        elif name in self.opaque or name in ("void", "FILE"):
            self._types[name] = None
        else:
            raise SyntaxError(f"no type {name}")

    def _callback(self, result, parameters):
        result, parameters = self._signature(result, parameters)
        kind = self.of(result)
        if kind is not None and issubclass(kind, Enum):
            kind = ctypes.c_int  # ctypes lets callbacks answer plain numbers only
        return ctypes.CFUNCTYPE(kind, *map(self.of, parameters))

    def of(self, declared, parameter=False):
        """The ctypes type of what was declared; arrays as parameters are pointers."""
        if declared.call:
            return self._callback(*declared.call)
        kind = self.type(declared.base)
        for _ in range(declared.stars - (declared.base in self.callbacks)):
            kind = _pointer(kind)
        for length in reversed(declared.lengths[1:] if parameter else declared.lengths):
            kind = kind * length
        return _pointer(kind) if parameter and declared.lengths else kind


def _pointer(kind):
    return {None: ctypes.c_void_p, ctypes.c_char: ctypes.c_char_p}.get(kind) or ctypes.POINTER(kind)


def _statements(text):
    text = re.sub(r"/\*.*?\*/", " ", text, flags=re.S).replace("\\\n", " ")
    lists = {name: re.findall(r"\bX\((\w+)", body) for name, body in re.findall(r"#define (\w+_LIST)\(X\)(.*)", text)}
    begins = dict(re.findall(r"#define (\w+_ENUM)\([^)]*\) (\w+)##name,", text))
    text = re.sub(r"#ifdef __cplusplus.*?#endif|^#.*?$", " ", text, flags=re.S | re.M)
    text = re.sub(r"\b(\w+_LIST)\((\w+_ENUM)\)",
                  lambda use: "".join(f"{begins[use[2]]}{item}," for item in lists[use[1]]), text)
    one = r"(?:[^;{}]|\{[^{}]*\})+;"
    rest = re.sub(one, "", text).strip()
    if rest:
        raise SyntaxError(f"no statement: {rest[:80]}")
    return re.findall(one, text)

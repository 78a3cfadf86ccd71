"""The shared library, called as its headers say.

`lib.world_step(world, 5)` calls scree_world_step. By the rules of scree.h,

- what fails raises Error;
- outputs, which stand last, are not passed: those that are missing are made, filled and answered, several as a tuple.
  What is made and has a function to free it is freed when nothing in Python uses it any more;
- arguments are what Python has: text and paths, words of enums, sequences for vectors, dictionaries for structs (what is
  not given has its default), functions for callbacks and progress, and objects of this package for the C object in
  their `_c`;
- a C object is in the hands of one thread at a time: see Turn."""
from __future__ import annotations

import contextlib
import ctypes
import ctypes.util
import os
import pathlib
import re
import reprlib
import threading
import weakref

from ._headers import Enum, Headers
from ._values import WHOLE_KINDS, column, set_fields, text_of, vector, whole, word_of

HERE = pathlib.Path(__file__).resolve().parent


class Error(Exception):
    """What the library refused: the sentence, and `status`, such as "BAD_FILE"."""

    def __init__(self, status: str, message: str) -> None:
        super().__init__(status, message)
        self.status = status

    def __str__(self) -> str:
        return self.args[1]


class Turn:
    """Whose turn a C object is. A call waits for another thread's, which is short, but not for one that steps: then it is
    refused, for what it would see or change would depend on the clock."""

    def __init__(self, noun):
        self.noun, self._lock, self._steps = noun, threading.RLock(), False

    @contextlib.contextmanager
    def taken(self, steps=False):
        while not self._lock.acquire(timeout=0.02):
            if self._steps:
                raise RuntimeError(f"another thread is stepping this {self.noun}: use it between its steps, or in the thread "
                                   "that steps")
        before, self._steps = self._steps, self._steps or steps
        try:
            yield
        finally:
            self._steps = before
            self._lock.release()


class Handle:
    """A pointer to a C object that only the library sees into. `within`: the handle of what it is part of."""

    def __init__(self, noun, pointer, within=None):
        self.pointer, self.within = pointer, within
        self.turn = within.turn if within else Turn(noun)

    def __reduce__(self):
        raise TypeError("a C object is not copied by its pointer")


def _own(thing, free, pointer):
    """Frees at the end of the thing's life; at the end of the process its memory goes anyway."""
    weakref.finalize(thing, free, pointer).atexit = False
    return thing


class Callback:
    """A Python function for C. What it raises must not pass through C: it ends the work, and is raised then."""

    def __init__(self, function):
        self.function, self.problem = function, None

    def __call__(self, *arguments):
        try:
            return self.function(*arguments)
        except BaseException as problem:
            self.problem = problem
            return False

    def raise_problem(self):
        if self.problem is not None:
            raise self.problem


class Function:
    """One of the library's."""

    def __init__(self, library, name):
        self.library, self.name = library, name
        headers = library.headers
        result, self.parameters = headers.signature(name)
        self.types = [headers.of(parameter, parameter=True) for parameter in self.parameters]
        self.c = getattr(library.c, name)
        self.c.restype, self.c.argtypes = headers.of(result), self.types
        self.fallible = result.base == "scree_status" and self.parameters[-1].base == "scree_error"
        self.input = [self._input(*both) for both in zip(self.parameters, self.types)]

    def _input(self, parameter, kind):
        """How an argument becomes a C value: a function of it, or None for as it is."""
        if parameter.base == "scree_progress":
            return self._progress
        if parameter.base in self.library.headers.callbacks:
            return kind
        if kind is ctypes.c_char_p:
            return lambda value: os.fsencode(value) if isinstance(value, (str, os.PathLike)) else value
        if parameter.const and parameter.lengths:
            array = kind._type_ * parameter.lengths[0]
            return lambda values: vector(values, parameter.name, array)
        if kind is not None and issubclass(kind, Enum):
            return lambda word: word_of(kind, word, parameter.name)
        if parameter.const and parameter.base in self.library.headers.structs:
            return lambda values: self.library.filled(parameter.base, values) if isinstance(values, dict) else values
        if kind in WHOLE_KINDS:
            return lambda value: whole(value, parameter.name, kind)
        return None

    def _progress(self, function):
        """Of (phase, fraction); cancels by answering False, and lets Ctrl-C through."""
        kind = self.library.type("progress")
        report = dict(kind._fields_)["report"]
        return kind(report(lambda _, phase, fraction: function(phase.decode(), fraction) is not False), None, 0.2)

    def _made(self, parameter, kind):
        """Room for an output, and what is passed for it."""
        if parameter.const or not (parameter.stars or parameter.lengths) or kind is ctypes.c_void_p:
            raise TypeError(f"{self.name} takes {parameter.name}")
        if parameter.lengths:
            room = (ctypes.c_char if kind is ctypes.c_char_p else kind._type_) * parameter.lengths[0]
            return room(), None
        if not issubclass(kind._type_, ctypes.Structure):
            return kind._type_(), None
        cell = kind._type_()
        return kind._type_.from_buffer(cell), cell  # a look into the cell, which outlives it until it is freed

    def _answer(self, parameter, value, cell):
        free = self.library.free_of(parameter.base)
        if parameter.stars == 2 and parameter.base in self.library.headers.opaque:
            return self.library.handle(parameter.base[len("scree_"):], value)
        if cell is not None:
            return _own(value, free, ctypes.byref(cell)) if free else value
        if isinstance(value, ctypes.Array):
            return text_of(value.value) if value._type_ is ctypes.c_char else column(value)
        return value.value

    def _call(self, given, passed):
        try:
            return self.c(*passed)
        except ctypes.ArgumentError as wrong:
            index = int(re.search(r"argument (\d+)", str(wrong))[1]) - 1
            parameter = self.parameters[index]
            meant = {"double": "number", "char": "text"}.get(parameter.base, parameter.base.removeprefix("scree_"))
            raise TypeError(f"{parameter.name} is {reprlib.repr(given[index])}; a {meant} is meant") from None

    def __call__(self, *given):
        count = len(self.parameters) - self.fallible
        if len(given) > count:
            raise TypeError(f"{self.name} takes {count} arguments, not {len(given)}")
        with contextlib.ExitStack() as stack:
            passed, callbacks = [], []
            for value, convert in zip(given, self.input):
                value = getattr(value, "_c", value)
                if isinstance(value, Handle):
                    stack.enter_context(value.turn.taken())
                    value = value.pointer
                elif convert is not None and value is not None:
                    if callable(value):
                        callbacks.append(value := Callback(value))
                    value = convert(value)
                passed.append(value)
            outputs = [(parameter, *self._made(parameter, kind)) for parameter, kind
                       in list(zip(self.parameters, self.types))[len(given):count]]
            passed += [room for _, room, _ in outputs]
            if not self.fallible:
                result = self._call(given, passed)
            else:
                result, error = None, self.library.type("error")()
                status = self._call(given, [*passed, error])
                if status.value != 0:
                    for callback in callbacks:
                        callback.raise_problem()
                    raise Error(status.words[status.value].upper(), text_of(error.message))
            for callback in callbacks:
                callback.raise_problem()
        made = [self._answer(*output) for output in outputs]
        if self.c.restype is not None and not self.fallible:
            made.insert(0, text_of(result) if self.c.restype is ctypes.c_char_p else result)
        return made[0] if len(made) == 1 else tuple(made) or None


class Library:
    """Its functions as attributes, without "scree_"."""

    def __init__(self):
        installed = HERE / "include/scree"
        self.headers = Headers(installed if installed.exists() else HERE.parents[1] / "include/scree")
        self.c = _load()

    def __getattr__(self, name):
        if "scree_" + name not in self.headers.functions:
            raise AttributeError(f"no function scree_{name} in the headers of scree")
        with self.headers.making:
            if name not in self.__dict__:
                setattr(self, name, Function(self, "scree_" + name))
            return self.__dict__[name]

    def type(self, name):
        return self.headers.type("scree_" + name)

    def filled(self, base, values):
        """A struct of these values, and of its defaults where the library has such."""
        noun = base[len("scree_"):]
        named = "default_" + noun
        struct = getattr(self, named)() if "scree_" + named in self.headers.functions else self.headers.type(base)()
        return set_fields(struct, values, noun.replace("_options", ""))

    def free_of(self, base):
        """The function that frees what has this type; None: none does."""
        return getattr(self, base[len("scree_"):] + "_free").c if base + "_free" in self.headers.functions else None

    def handle(self, noun, pointer):
        """Of a C object that was made, a c_void_p."""
        return _own(Handle(noun, pointer.value), self.free_of("scree_" + noun), pointer)

    def names(self, function, *first):
        """What function(*first, 0), (*first, 1), ... answers up to None."""
        found = []
        while (name := getattr(self, function)(*first, len(found))) is not None:
            found.append(name)
        return found


def interface_version(version):
    """The part of a version that names the interface: 0.MINOR before 1.0, then MAJOR."""
    major, minor = version.strip().split(".")[:2]
    return f"0.{minor}" if major == "0" else major


def _candidates():
    """SCREE_LIBRARY; beside an installed module (PREFIX/lib/python3/dist-packages/scree and the like); the system's."""
    named = os.environ.get("SCREE_LIBRARY")
    if named:
        yield named
        return
    version = HERE / "VERSION"
    name = "libscree.so." + interface_version(version.read_text()) if version.exists() else "libscree.so"
    for folder in (HERE, *HERE.parents):
        for library in [folder / name, *sorted(folder.glob(f"lib*/{name}")), *sorted(folder.glob(f"lib*/*/{name}"))]:
            if library.exists():
                yield str(library)
    found = ctypes.util.find_library("scree")
    if found:
        yield found


def _load():
    for path in _candidates():
        try:
            return ctypes.CDLL(path)
        except OSError as problem:
            raise ImportError(f"scree: cannot load {path}: {problem}") from problem
    raise ImportError("scree: libscree.so was not found; install scree, or name the file in SCREE_LIBRARY")


lib = Library()
_version_file = HERE / "VERSION"
if _version_file.exists() and _version_file.read_text().strip() != lib.version():
    raise ImportError(f"scree: the module is of version {_version_file.read_text().strip()}, the library of "
                      f"{lib.version()}")

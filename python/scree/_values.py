"""Between C values and Python's: numpy arrays where numpy is there, memoryviews and lists where it is not."""
from __future__ import annotations

import ctypes
import difflib
import html
import operator
import types
from typing import TYPE_CHECKING, Any

from ._headers import Enum

try:
    import numpy
except ImportError:
    numpy = None  # type: ignore[assignment]

WHOLE_KINDS = (ctypes.c_int, ctypes.c_size_t, ctypes.c_uint32, ctypes.c_uint64)
UNITS = {"m": 1, "mm": 1e-3, "cm": 1e-2, "um": 1e-6, "km": 1e3, "inch": 0.0254, "in": 0.0254, "ft": 0.3048}


if TYPE_CHECKING:
    class Fields:
        """Values by name, each with its type."""

        def __init__(self, **values: Any) -> None: ...

    class Record(Fields):
        def __getattr__(self, name: str) -> Any: ...
else:
    class Record(types.SimpleNamespace):
        """Values by name; vars() makes a dictionary of it. A notebook shows it as a table."""

        def _repr_html_(self) -> str:
            return rows_html(vars(self))

    Fields = Record

KINDS: dict[str, Any] = {}  # the classes of _records.py by the C struct


def rows_html(values):
    """A table of names and values; what is long is cut."""
    def cell(value):
        if isinstance(value, Record):
            return rows_html(vars(value))
        if isinstance(value, dict):
            return rows_html(value)
        text = f"{value:.6g}" if isinstance(value, float) else str(value)
        return html.escape(text if len(text) <= 200 else text[:200] + " ...")

    return "<table>" + "".join(f"<tr><th>{html.escape(str(name))}</th><td>{cell(value)}</td></tr>"
                               for name, value in values.items()) + "</table>"


def metres(unit):
    """"mm" to 1e-3; a number is one already."""
    if isinstance(unit, str):
        if unit not in UNITS:
            raise ValueError(f"'{unit}' is no unit of length ({', '.join(UNITS)})")
        return UNITS[unit]
    return float(unit)


def whole(value, what, kind=ctypes.c_size_t):
    """value, where it is a whole number that the C type holds: ctypes would wrap any other around."""
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{what} is {value!r}; a whole number") from None
    bits, signed = 8 * ctypes.sizeof(kind), kind(-1).value < 0
    low, high = (-(1 << bits - 1), (1 << bits - 1) - 1) if signed else (0, (1 << bits) - 1)
    if not low <= number <= high:
        raise ValueError(f"{what} is {number}; at " + (f"least {low}" if number < low else f"most {high}"))
    return number


def vector(values, what, kind):
    """A C array of as many numbers as its type has: ctypes would fill up with zeros what is missing."""
    try:
        numbers = list(values)
    except TypeError:
        raise TypeError(f"{what} is {values!r}; {kind._length_} numbers") from None
    if len(numbers) != kind._length_:
        raise ValueError(f"{what} has {len(numbers)} number{'' if len(numbers) == 1 else 's'}; it takes {kind._length_}")
    return kind(*numbers)


def index_of(word, words, what):
    if word not in words:
        near = difflib.get_close_matches(str(word), words, 1)
        raise ValueError(f"{what} '{word}' is none of {', '.join(words)}" + (f": do you mean {near[0]}?" if near else ""))
    return words.index(word)


def given(**values):
    """Those that are not None."""
    return {name: value for name, value in values.items() if value is not None}


def word_of(kind, word, what):
    """The C value of an enum's word."""
    return word if isinstance(word, (int, Enum)) else kind(index_of(word, kind.words, what))


def text_of(value):
    return None if value is None else value.decode(errors="replace")


def table(pointer, rows, columns, owner):
    """rows x columns values at a C pointer, without copying: a numpy array, or a 2-D memoryview. Read only; keeps
    owner alive."""
    if rows == 0:
        return numpy.zeros((0, columns)) if numpy else []
    kind = pointer._type_
    block = ctypes.cast(pointer, ctypes.POINTER(kind * (rows * columns))).contents
    block.owner = owner
    if numpy:
        values = numpy.frombuffer(block, dtype=kind).reshape(rows, columns)
        values.flags.writeable = False
        return values
    letter = {ctypes.c_double: "d", ctypes.c_float: "f"}.get(kind, "I")
    return memoryview(block).cast("B").cast(letter, (rows, columns)).toreadonly()


def column(values):
    """Numbers as a numpy array where there is numpy, else a list; nested C arrays too."""
    values = [list(value) if isinstance(value, ctypes.Array) else value for value in values]
    return numpy.array(values) if numpy else values


def c_array(kind, values, width=None):
    """A C array of nested sequences or of a numpy array, flattened; and its rows, where width is given."""
    if numpy is not None:
        dtype = numpy.float64 if kind is ctypes.c_double else numpy.uint32
        given = numpy.asarray(values)
        flat = numpy.ascontiguousarray(given, dtype=dtype)
        if kind is not ctypes.c_double and (flat != given).any():
            whole(given[flat != given][0], "an index", kind)
        if width and (flat.ndim != 2 or flat.shape[1] != width):
            raise ValueError(f"expected rows of {width} values, got an array of shape {flat.shape}")
        rows = len(flat)
        flat = flat.reshape(-1)
        block = (kind * max(1, len(flat)))()
        ctypes.memmove(block, flat.ctypes.data, flat.nbytes)
        return block, rows
    rows = [list(row) for row in values] if width else [list(values)]
    if width and any(len(row) != width for row in rows):
        raise ValueError(f"expected rows of {width} values")
    flat = [value for row in rows for value in row]
    if kind is not ctypes.c_double:
        flat = [whole(value, "an index", kind) for value in flat]
    return (kind * max(1, len(flat)))(*flat), len(rows) if width else len(flat)


def record(struct):
    """A C struct as a Record: arrays as numpy arrays or lists, text as str, enums as words; without what it points to."""
    result = {}
    for name, kind in struct._fields_:
        value = getattr(struct, name)
        if issubclass(kind, Enum):
            value = kind.words[value.value] if value.value < len(kind.words) else None
        elif isinstance(value, bytes):
            value = text_of(value)
        elif isinstance(value, ctypes.Structure):
            value = record(value)
        elif isinstance(value, ctypes.Array):
            value = column(value)
        elif kind is ctypes.c_void_p or isinstance(value, (ctypes._Pointer, ctypes._CFuncPtr)):
            continue
        result[name] = value
    return KINDS.get(type(struct).__name__, Record)(**result)


def set_fields(struct, values, what):
    """Options by keyword, those of a struct within as a dictionary; an unknown one is an error that lists them."""
    known = dict(struct._fields_)
    for name, value in values.items():
        if name not in known:
            raise TypeError(f"{what} has no option '{name}'; there are {', '.join(known)}")
        kind = known[name]
        if issubclass(kind, ctypes.Structure):
            set_fields(getattr(struct, name), value, name)
            continue
        if issubclass(kind, ctypes.Array):
            value = vector(value, f"{what}: {name}", kind)
        elif issubclass(kind, Enum):
            value = word_of(kind, value, name)
        elif kind in WHOLE_KINDS:
            value = whole(value, f"{what}: {name}", kind)
        elif kind is ctypes.c_char_p and isinstance(value, str):
            value = value.encode()
        elif issubclass(kind, ctypes._CFuncPtr):
            value = kind(value)
        elif hasattr(value, "_c"):
            value = ctypes.pointer(value._c)
        setattr(struct, name, value)
    return struct

"""Between C values and Python's: numpy arrays where numpy is there, memoryviews and lists where it is not."""
import ctypes
import operator
import types

try:
    import numpy
except ImportError:
    numpy = None

WHOLE_KINDS = (ctypes.c_int, ctypes.c_size_t, ctypes.c_uint32, ctypes.c_uint64)
UNITS = {"m": 1, "mm": 1e-3, "cm": 1e-2, "um": 1e-6, "km": 1e3, "inch": 0.0254, "in": 0.0254, "ft": 0.3048}


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
        raise ValueError(f"{what} is {number}; from {low} to {high}")
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
        raise ValueError(f"{what} '{word}' is none of {', '.join(words)}")
    return words.index(word)


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
    """A list of numbers as a numpy array where there is numpy."""
    return numpy.array(values) if numpy else list(values)


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


def from_struct(struct, words=()):
    """A C struct as a namespace: arrays as numpy arrays or lists, text as str, enums as the words given by field."""
    words = dict(words)
    result = {}
    for name, kind in struct._fields_:
        value = getattr(struct, name)
        if name in words:
            value = words[name][value]
        elif isinstance(value, bytes):
            value = value.decode(errors="replace")
        elif isinstance(value, ctypes.Structure):
            value = from_struct(value)
        elif isinstance(value, ctypes.Array):
            value = [list(row) if isinstance(row, ctypes.Array) else row for row in value]
            value = column(value)
        elif isinstance(value, ctypes._Pointer):
            continue
        result[name] = value
    return types.SimpleNamespace(**result)


def set_fields(struct, values, what):
    """Options by keyword, those of a struct within as a dictionary; an unknown one is an error that lists them."""
    known = dict(struct._fields_)
    for name, value in values.items():
        if name not in known:
            raise TypeError(f"{what} has no option '{name}'; there are {', '.join(known)}")
        if isinstance(getattr(struct, name), ctypes.Structure):
            set_fields(getattr(struct, name), value, name)
            continue
        if isinstance(getattr(struct, name), ctypes.Array):
            value = vector(value, f"{what}: {name}", known[name])
        elif known[name] in WHOLE_KINDS:
            value = whole(value, f"{what}: {name}", known[name])
        setattr(struct, name, value)
    return struct

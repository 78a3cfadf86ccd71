#!/usr/bin/env python3
"""Makes what an object file of 64-bit ELF hides visible to who links it: tests look inside. usage: unhide.py FILE.o"""
import struct
import sys

GLOBAL, UNDEFINED, HIDDEN, SYMBOLS = 1, 0, 2, 2
with open(sys.argv[1], "r+b") as file:
    data = bytearray(file.read())
    assert data[:6] == b"\x7fELF\x02\x01", "no little-endian 64-bit ELF"
    (sections,) = struct.unpack_from("<Q", data, 40)
    size, count = struct.unpack_from("<HH", data, 58)
    for i in range(count):
        kind, begin, length = struct.unpack_from("<4xI16xQQ", data, sections + i * size)
        if kind != SYMBOLS:
            continue
        for at in range(begin, begin + length, 24):
            info, other, section = struct.unpack_from("<BBH", data, at + 4)
            if info >> 4 == GLOBAL and section != UNDEFINED and other & 3 == HIDDEN:
                data[at + 5] = other & ~3
    file.seek(0)
    file.write(data)

"""Pages of results."""
from __future__ import annotations

import ctypes
import os
from typing import Sequence

from ._library import lib


def report(folders: str | os.PathLike | Sequence[str | os.PathLike], path: str | os.PathLike, overwrite: bool = False) -> None:
    """One page for the browser of folders with results (`scree report`)."""
    folders = [folders] if isinstance(folders, (str, os.PathLike)) else list(folders)
    names = (ctypes.c_char_p * max(1, len(folders)))(*[os.fsencode(f) for f in folders])
    lib.page_write(names, len(folders), path, overwrite)

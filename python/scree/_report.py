"""Pages of results."""
from __future__ import annotations

import ctypes
import html
import os
import pathlib
from typing import Sequence

from ._library import lib


class Page(type(pathlib.Path())):  # type: ignore[misc]
    """The path of a page that `report` wrote; a notebook shows the page itself, with its 3D views, in a frame."""

    def _repr_html_(self) -> str:
        page = html.escape(self.read_text(encoding="utf-8"), quote=True)
        return f'<iframe title="{html.escape(self.name, quote=True)}" width="100%" height="700" srcdoc="{page}"></iframe>'


def report(folders: str | os.PathLike | Sequence[str | os.PathLike], path: str | os.PathLike, overwrite: bool = True) -> Page:
    """One page for the browser of folders with results (`scree report`): its path, which a notebook shows as the page."""
    folders = [folders] if isinstance(folders, (str, os.PathLike)) else list(folders)
    names = (ctypes.c_char_p * max(1, len(folders)))(*[os.fsencode(f) for f in folders])
    lib.page_write(names, len(folders), path, overwrite)
    return Page(path)

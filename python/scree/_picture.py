"""What a notebook shows: a picture, where the library was built with them, and a table."""
from __future__ import annotations

import base64
import html as _html
import pathlib
import tempfile
from typing import Any

from ._library import Error, lib
from ._values import Fields, rows_html, set_fields


class Picture:
    """A PNG that a notebook shows; data are its bytes."""

    def __init__(self, draw: Any, width: int, height: int, path: Any = None) -> None:
        """draw(options) answers an image."""
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "picture.png"
            lib.image_write_png(draw({"width": width, "height": height}), file, False)
            self.data = file.read_bytes()
        if path is not None:
            pathlib.Path(path).write_bytes(self.data)

    def _repr_png_(self) -> bytes:
        return self.data


def html(thing, draw, facts: Fields) -> str:
    """draw(options) answers an image."""
    picture = ""
    try:
        data = Picture(draw, 400, 300).data
        picture = f'<img alt="" src="data:image/png;base64,{base64.b64encode(data).decode()}">'
    except Error as refused:  # nothing to draw, or a library without pictures
        picture = f"<p>{_html.escape(str(refused))}</p>"
    return f"<div><p>{_html.escape(repr(thing))}</p>{picture}{rows_html(vars(facts))}</div>"


def scene_of(*captioned):
    """What scree_render draws of (mesh, caption) side by side."""
    cells = (lib.type("render_cell") * len(captioned))()
    for cell, (mesh, caption) in zip(cells, captioned):
        item = lib.type("render_item")()
        set_fields(item, {"mesh": mesh, "color": (0.6, 0.62, 0.66)}, "an item")
        set_fields(cell, {"caption": caption, "item_count": 1}, "a cell")
        cell.items = (type(item) * 1)(item)
    return cells, len(captioned)

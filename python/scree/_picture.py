"""What a notebook shows: a picture, where the library was built with them, and a table."""
from __future__ import annotations

import base64
import html as _html
import pathlib
import tempfile

from ._library import Error, lib
from ._values import Record, rows_html, set_fields


def html(thing, draw, facts: Record) -> str:
    """draw(options) answers an image."""
    options = {"width": 400, "height": 300, "samples": 8}
    picture = ""
    try:
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "picture.png"
            lib.image_write_png(draw(options), path, False)
            picture = f'<img alt="" src="data:image/png;base64,{base64.b64encode(path.read_bytes()).decode()}">'
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

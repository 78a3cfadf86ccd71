"""What has a checkpoint is copied and pickled by it."""
from __future__ import annotations

import pathlib
import tempfile
from typing import Any


class Saved:
    """Of a class with save and load."""

    save: Any

    @classmethod
    def _of(cls, c):
        made = cls.__new__(cls)
        made._c = c
        return made

    def __reduce__(self) -> tuple:
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "checkpoint.scree"
            self.save(path)
            return _load, (type(self), path.read_bytes())


def _load(kind, checkpoint):
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "checkpoint.scree"
        path.write_bytes(checkpoint)
        return kind.load(path)

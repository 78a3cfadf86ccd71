"""What runs leave in folders: where bodies were, and the page that shows it."""
import ctypes
import os
import pathlib
import weakref

from . import _library as c
from ._library import call, lib
from ._values import column, table


class Motion:
    """Where every wall and body of a scene was: `time` (s) of each frame; `poses`, frames x (walls, then bodies) x 7
    values: position (m) and quaternion w x y z, NaN where a body is not in. path: motion.scree, or its folder."""

    def __init__(self, path):
        path = pathlib.Path(path)
        self._struct = c.scree_motion()
        call("motion_read", os.fsencode(path / "motion.scree" if path.is_dir() else path), self._struct)
        weakref.finalize(self, lib["motion_free"], self._struct)
        frames, bodies = self._struct.frame_count, self._struct.body_count
        self.body_count = bodies
        self.time = column(self._struct.time[:frames])
        flat = table(self._struct.poses, frames * bodies, 7, self)
        if hasattr(flat, "reshape"):
            self.poses = flat.reshape(frames, bodies, 7)
        else:
            rows = flat.tolist()
            self.poses = [rows[f * bodies:(f + 1) * bodies] for f in range(frames)]

    def __len__(self):
        return self._struct.frame_count


def report(folders, path, overwrite=False):
    """One page for the browser of folders with results (`scree report`)."""
    folders = [folders] if isinstance(folders, (str, os.PathLike)) else list(folders)
    names = (ctypes.c_char_p * max(1, len(folders)))(*[os.fsencode(f) for f in folders])
    call("page_write", names, len(folders), os.fsencode(path), overwrite)

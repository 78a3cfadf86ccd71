"""Calibrations: the parameters that measurements can tell, and the best settings of a design."""
import ctypes
import json
import os
import pathlib
import types
import weakref

from . import _library as c
from ._library import Progress, call, lib
from ._values import table
from ._world import Owner


def calibrate(path, folder, progress=None):
    """Runs the calibration of a file (docs/reference/calibrate.md) in a folder, or goes on with it, as `scree calibrate`
    does with one worker; writes its tables, figures and report.html there. A namespace: `samples` of the posterior, a row
    each, with a column for each of `names`; `parameters`, `trades`, `answers`, `advice` and what else
    calibration.json has."""
    return _run(path, folder, progress, False)


def optimise(path, folder, progress=None):
    """The same of a file that has minimise or maximise, as `scree optimise`: `settings`, the best first."""
    return _run(path, folder, progress, True)


def _run(path, folder, progress, search):
    handle = ctypes.c_void_p()
    call("calibration_read", os.fsencode(path), handle)
    owner = Owner("calibration_free", handle)
    if lib["calibration_is_search"](handle) != search:
        raise ValueError(f"{path}: is for scree.{'calibrate' if search else 'optimise'}")
    call("calibration_open", handle, os.fsencode(folder))
    with Progress(progress) as told:
        call("calibration_work", handle, 1, None, told)
    result = c.scree_calibration_result()
    call("calibration_analyse", handle, result)
    weakref.finalize(owner, lib["calibration_result_free"], result)
    call("calibration_report_write", result, os.fsencode(folder))
    names = (ctypes.c_char_p * 1)(os.fsencode(folder))
    call("page_write", names, 1, os.fsencode(pathlib.Path(folder) / "report.html"), True)
    found = json.loads((pathlib.Path(folder) / "calibration.json").read_text())
    found["names"] = [parameter["name"] for parameter in found["parameters"]]
    if not search:
        found["samples"] = table(result.samples, result.sample_count, result.parameter_count, owner)
    return types.SimpleNamespace(**found)

"""Calibrations: the parameters that measurements can tell, and the best settings of a design."""
from __future__ import annotations

import json
import os
import pathlib

from ._library import lib
from ._mesh import Progress
from ._report import report
from ._values import Record, table


def calibrate(path: str | os.PathLike, folder: str | os.PathLike, progress: Progress = None) -> Record:
    """Runs the calibration of a file (docs/reference/calibrate.md) in a folder, or goes on with it, as `scree calibrate`
    does with one worker; writes its tables, figures and report.html there. `samples` of the posterior, a row
    each, with a column for each of `names`; `parameters`, `trades`, `answers`, `advice` and what else
    calibration.json has."""
    return _run(path, folder, progress, False)


def optimise(path: str | os.PathLike, folder: str | os.PathLike, progress: Progress = None) -> Record:
    """The same of a file that has minimise or maximise, as `scree optimise`: `settings`, the best first."""
    return _run(path, folder, progress, True)


def _run(path, folder, progress, search):
    calibration = lib.calibration_read(path)
    if lib.calibration_is_search(calibration) != search:
        raise ValueError(f"{path}: is for scree.{'calibrate' if search else 'optimise'}")
    lib.calibration_open(calibration, folder)
    lib.calibration_work(calibration, 1, None, progress)
    result = lib.calibration_analyse(calibration)
    lib.calibration_report_write(result, folder)
    report(folder, pathlib.Path(folder) / "report.html", overwrite=True)
    found = json.loads((pathlib.Path(folder) / "calibration.json").read_text(encoding="utf-8"))
    found["names"] = [parameter["name"] for parameter in found["parameters"]]
    if not search:
        found["samples"] = table(result.samples, result.sample_count, result.parameter_count, result)
    return Record(**found)

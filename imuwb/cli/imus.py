"""The IMUs of a log on the command line: the first with a note on the others, one by its name, or all, which are compared."""

from collections.abc import Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

from imuwb import registry
from imuwb.analysis import Analysis, offers
from imuwb.cli.options import Request
from imuwb.errors import UsageError
from imuwb.log import Log
from imuwb.notes import Note
from imuwb.selection import ALL, each_imu, with_first
from imuwb.texts import names_text


def compares(analysis: Analysis, request: Request) -> bool:
    """Return whether the IMUs of a log are compared; an analysis that examines every IMU does not need it."""
    return request.part.imu == ALL and not getattr(analysis, "EVERY_IMU", False)


def comparison(name: str, analysis: Analysis, paths: Sequence[object], request: Request) -> Analysis:
    """Return the analysis that compares the IMUs of a log, or of logs where it takes several.

    Raises:
        UsageError: the analysis cannot, there are several logs of which it takes one, or an option needs a single IMU.
    """
    if not offers(analysis, "compare_imus"):
        able = [one for one in registry.installed(registry.ANALYSES) if offers(_loaded(one), "compare_imus")]
        raise UsageError(
            f"--imu {ALL}: {name} analyses one IMU; give its name (imuwb info lists them), or compare all with {' or '.join(able)}"
        )
    given = {
        "--save-model": request.outputs.save_model is not None, "--force-model": request.outputs.force_model,
        "--study": bool(request.conditions.study),
    }  # fmt: skip
    for option, is_given in given.items():
        if is_given:
            raise UsageError(f"{option} needs one IMU, and --imu {ALL} compares all; give the name of one with --imu")
    if len(paths) > 1 and not getattr(analysis, "IMUS_OF_LOGS", False):
        raise UsageError(f"--imu {ALL} compares the IMUs of one log; {len(paths)} logs are given")
    plugin = cast("Any", analysis)
    parts = {"Parameters": plugin.Parameters, "run": plugin.compare_imus, "draw": plugin.draw_imus}
    if offers(analysis, "answer_imus"):
        parts["answer"] = plugin.answer_imus
    return cast("Analysis", SimpleNamespace(**parts))


def _loaded(name: str) -> object:
    return registry.load(registry.installed(registry.ANALYSES)[name])


def split(logs: Sequence[Log], *, compared: bool) -> list[Log]:
    """Return the logs, or, where IMUs are compared, one log for each IMU."""
    return [one for log in logs for one in each_imu(log) or (log,)] if compared else list(logs)


def with_choice(log: Log, analysis: Analysis, parameters: object, request: Request) -> Log:
    """Return a log whose first IMU is the one that is analysed; a note names it if the user has not, and there are others."""
    able = [imu for imu in log.imus if imu.axes()]  # an IMU may be a thermometer only
    if len(able) < 2 or request.part.imu is not None or getattr(analysis, "EVERY_IMU", False):  # noqa: PLR2004 - a choice
        return log
    first = able[0].name
    chosen = cast("Any", analysis).imu_of(log, parameters) if offers(analysis, "imu_of") else first
    why = "" if chosen == first else f", because {first} lacks what the analysis needs"
    compare = f", or compare all with --imu {ALL}" if offers(analysis, "compare_imus") else ""
    names = names_text([imu.name for imu in able])
    text = f"{len(able)} IMUs ({names}): {chosen} is analysed{why}; choose another with --imu{compare}"
    log = with_first(log, chosen)
    return replace(log, notes=(*log.notes, Note("imus", text)))

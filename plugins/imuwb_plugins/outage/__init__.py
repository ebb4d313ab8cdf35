"""Drift of a loosely coupled GNSS/INS filter in outages: by error model, with intervals, and whether its sigma holds.

Every fix of the log is used once; then outages branch off behind the fixes, a sweep of all starts or those of --at, and each
filter's drift is measured against the best reference there is: the log's truth, RTK-fixed points, or a filter's own run.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from imuwb_plugins.outage.parameters import Parameters

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from imuwb.analysis import Review
    from imuwb.log import Log
    from imuwb_plugins.outage.result import Result

__all__ = ["DEMO", "Parameters", "draw", "outputs", "run", "write_outputs"]

DEMO = "drive"


def run(logs: Sequence[Log], parameters: Parameters) -> Result:
    """Return what each filter does in the outages."""
    from imuwb_plugins.outage import compute  # noqa: PLC0415 - help must not wait for numpy

    return compute.run(logs[0], parameters)


def draw(result: Result, review: Review) -> None:
    """Show tables, drift curves, envelopes, tracks and consistency."""
    from imuwb_plugins.outage import show  # noqa: PLC0415 - as above

    show.draw(result, review)


def outputs(parameters: Parameters) -> tuple[Path, ...]:
    """Return the files that are written beside the recording."""
    from imuwb.writers.trajectory import check_trajectory  # noqa: PLC0415 - as above

    if parameters.navigation is not None:
        check_trajectory(parameters.navigation)
    return tuple(path for path in (parameters.navigation, parameters.save_filter) if path is not None)


def write_outputs(result: Result, parameters: Parameters) -> None:
    """Write the last filter's solution, and the filter."""
    from imuwb.navigation.filter_document import write_filter  # noqa: PLC0415 - as above
    from imuwb.writers import write_text  # noqa: PLC0415
    from imuwb_plugins.outage import trajectory  # noqa: PLC0415

    if parameters.navigation is not None:
        trajectory.write(result, parameters.navigation)
    if parameters.save_filter is not None:
        last = list(result.replay.runs.values())[-1].solution.model
        write_text(parameters.save_filter, write_filter(last))

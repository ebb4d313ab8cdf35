"""The files of an outage replay: the last filter's run, and the filter."""

from pathlib import Path

from imuwb.writers import write_text
from imuwb.writers.trajectory import check_trajectory, write_trajectory
from imuwb_plugins.outage.parameters import Parameters
from imuwb_plugins.outage.result import Result


def outputs(parameters: Parameters) -> tuple[Path, ...]:
    """Return the files that are written besides the recording."""
    if parameters.navigation is not None:
        check_trajectory(parameters.navigation)
    return tuple(path for path in (parameters.navigation, parameters.save_filter) if path is not None)


def write_outputs(result: Result, parameters: Parameters) -> None:
    """Write the last filter's run, and the filter."""
    if parameters.navigation is not None:
        write_trajectory(*result.navigation, parameters.navigation)
    if parameters.save_filter is not None:
        write_text(parameters.save_filter, result.filters[-1].document)

"""The files of an outage replay: the last filter's run, forward and smoothed, and the filter."""

from pathlib import Path

from imuwb.sidecars import sidecar_beside
from imuwb.writers import write_text
from imuwb.writers.trajectory import check_trajectory, write_smoothed, write_trajectory
from imuwb_plugins.outage.parameters import Parameters
from imuwb_plugins.outage.result import Result


def outputs(parameters: Parameters) -> tuple[Path, ...]:
    """Return the files that are written besides the recording."""
    trajectories = [path for path in (parameters.navigation, parameters.smoothed) if path is not None]
    for path in trajectories:
        check_trajectory(path)
    sidecars = [sidecar_beside(path) for path in trajectories if path.suffix == ".csv"]
    return (*trajectories, *sidecars, *(() if parameters.save_filter is None else (parameters.save_filter,)))


def write_outputs(result: Result, parameters: Parameters) -> None:
    """Write the last filter's run, forward and smoothed, and the filter."""
    if parameters.navigation is not None:
        write_trajectory(*result.navigation, parameters.navigation)
    if parameters.smoothed is not None and result.smoothed is not None:
        run = result.smoothed
        write_smoothed(run.smoothed, run.forward, run.backward, run.quaternion, parameters.smoothed)
    if parameters.save_filter is not None:
        write_text(parameters.save_filter, result.filters[-1].document)

"""The smoothed trajectory of the last filter, for --smoothed."""

from dataclasses import replace

import numpy as np

from imuwb.arrays import Booleans
from imuwb.geodesy import euler_of_quaternion
from imuwb.log import SECOND, Log, Origin, Reference
from imuwb.navigation import NavigationTrack, Separation, separation
from imuwb.notes import Note
from imuwb_plugins.outage.parameters import Parameters
from imuwb_plugins.outage.result import Result, SmoothedRun


def with_smoothed(result: Result, parameters: Parameters) -> Result:
    """Return a result with the smoothed trajectory, if the user wants it."""
    if parameters.smoothed is None or result.replay is None:
        return result
    found = separation(list(result.replay.runs.values())[-1].solution)
    log = result.replay.prepared.log
    every = np.ones(found.time.size, dtype=bool)
    known = np.asarray(np.isfinite(np.column_stack([found.backward.sigma, found.backward.position])).all(axis=1))
    run = SmoothedRun(
        _reference(log, found, "smoothed", found.smoothed, every),
        _reference(log, found, "forward", found.forward, every),
        _reference(log, found, "backward", found.backward, known),
        found.smoothed.quaternion,
    )
    text = (
        f"smoothed trajectory of {found.model}: the forward and the backward run agree within their own 95 % interval at "
        f"{found.inside95() * 100:.0f} % of the fixes (north and east)"
    )
    return replace(result, smoothed=run, notes=(*result.notes, Note("separation", text)))


def _reference(log: Log, found: Separation, kind: str, track: NavigationTrack, rows: Booleans) -> Reference:
    time = (log.zero or 0) + np.rint(found.time[rows] * SECOND).astype(np.int64)
    sigma = track.sigma[rows]
    return Reference(
        f"{kind}, {found.model} of imuwb", time, track.position[rows], track.velocity[rows],
        euler_of_quaternion(track.quaternion[rows]), Origin("SI", "NED", log.imu().origin.epoch), sigma[:, :3],
        sigma[:, 3:6], sigma[:, 6:],
    )  # fmt: skip

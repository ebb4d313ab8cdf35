"""The track of the last filter over the whole log."""

import numpy as np

from imuwb.arrays import Floats
from imuwb.log import SECOND, Origin, Reference
from imuwb.replay import Replay


def navigation(replay: Replay) -> tuple[Reference, Floats]:
    """Return the last filter's run over the whole log, at its fixes, and its quaternions."""
    solution, log = list(replay.runs.values())[-1].solution, replay.prepared.log
    time = (log.zero or 0) + np.rint(solution.time * SECOND).astype(np.int64)
    kept = np.concatenate([[True], np.diff(time) > 0])
    reference = Reference(
        f"{solution.model.name} of imuwb", time[kept], solution.position[kept], solution.velocity[kept],
        solution.euler[kept], Origin("SI", "NED", log.imu().origin.epoch),
    )  # fmt: skip
    return reference, solution.quaternion[kept]

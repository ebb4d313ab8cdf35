"""Writes a filter's solution."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from imuwb.log import SECOND, Origin, Reference
from imuwb.writers.trajectory import write_trajectory

if TYPE_CHECKING:
    from pathlib import Path

    from imuwb_plugins.outage.result import Result


def write(result: Result, path: Path) -> None:
    """Write the last filter's run over the whole log, at its fixes."""
    solution = list(result.replay.runs.values())[-1].solution
    log = result.replay.prepared.log
    time = (log.zero or 0) + np.rint(solution.time * SECOND).astype(np.int64)
    kept = np.concatenate([[True], np.diff(time) > 0])
    reference = Reference(
        f"{solution.model.name} of imuwb", time[kept], solution.position[kept], solution.velocity[kept],
        solution.euler[kept], Origin("SI", "NED", log.imu().origin.epoch),
    )  # fmt: skip
    write_trajectory(reference, solution.quaternion[kept], path)

"""The tracks of the filters: in some outages, and over the whole log."""

import numpy as np

from imuwb.arrays import Floats
from imuwb.log import SECOND, Origin, Reference
from imuwb.replay import Replay, without_overlap
from imuwb_plugins.outage.result import OutageTrack, Tracks
from imuwb_plugins.outage.summary import LISTED

DRAWN = 6  #: outages of each duration


def tracks(replay: Replay) -> tuple[Tracks, ...]:
    """Return the tracks of some outages of all durations, or of the longest one if there are many outages."""
    durations = list(replay.scored)
    few = sum(int(rows.sum()) for rows in replay.scored.values()) <= LISTED
    return tuple(_of_duration(replay, d) for d in (durations if few else durations[-1:]) if replay.scored[d].any())


def _of_duration(replay: Replay, duration: float) -> Tracks:
    rows = np.flatnonzero(replay.scored[duration])
    runs = {name: own.outages[duration] for name, own in replay.runs.items()}
    start = next(iter(runs.values())).scores.start
    apart = rows[without_overlap(start[rows], duration)]
    chosen = apart[np.unique(np.linspace(0, apart.size - 1, min(DRAWN, apart.size)).astype(int))]
    outages: list[OutageTrack] = []
    for i in chosen:
        ends = {name: float(own.scores.horizontal[i, -1]) for name, own in runs.items()}
        positions = {name: own.drift.state[i, :, :3] for name, own in runs.items()}
        best, worst = min(ends, key=ends.__getitem__), max(ends, key=ends.__getitem__)
        outages.append(OutageTrack(float(start[i]), positions, ends, best, worst))
    return Tracks(duration, rows.size, tuple(outages))


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

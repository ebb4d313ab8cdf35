"""Given outages one by one: where the filters go in the plane, and how far each is from its own run."""

import numpy as np

from imuwb.replay import Replay
from imuwb_plugins.outage.drive_outages import belief, every_outage
from imuwb_plugins.outage.result import OutagePicture

MOST = 12  #: outages that are shown one by one
AROUND, STEP = 5.0, 0.2  #: s of the reference before and after an outage, and between its points


def pictures(replay: Replay) -> tuple[OutagePicture, ...]:
    """Return the outages of a replay by start; none if they are many."""
    outages = sorted(every_outage(replay), key=lambda own: (own.start, own.duration))
    if len(outages) > MOST:
        return ()
    made: list[OutagePicture] = []
    for number, own in enumerate(outages, 1):
        runs = {name: run.outages[own.duration] for name, run in replay.runs.items()}
        time = np.arange(own.start - AROUND, own.start + own.duration + AROUND, STEP)
        near = replay.reference.at(time)[0]
        made.append(
            OutagePicture(
                own.given or str(number), near[np.isfinite(near).all(axis=1)],
                {name: belief(replay, name, own).position for name in runs}, next(iter(runs.values())).own.elapsed,
                {name: run.own.horizontal[own.row] for name, run in runs.items()},
            )
        )  # fmt: skip
    return tuple(made)

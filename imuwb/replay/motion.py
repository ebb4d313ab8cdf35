"""What the vehicle did in an outage, told by the reference."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from imuwb.replay.replay import Replay

SLOW = 1.0  #: m/s, below which it stands
STOPPED = 0.3  #: of an outage: from here on it is a stop
TURN = np.radians(45)  #: of course, within an outage
FAST = 70 / 3.6  #: m/s, mean


def motion_classes(found: Replay, duration: float) -> NDArray[np.str_]:
    """Return "stop", "turn", "fast" or "straight" of each outage of a duration, (s,)."""
    drift = next(iter(found.runs.values())).outages[duration].drift
    velocity = found.reference.at(np.concatenate([drift.start[:, None], drift.time], axis=1))[1]
    speed = np.hypot(velocity[..., 0], velocity[..., 1])
    course = np.arctan2(velocity[..., 1], velocity[..., 0])
    # Who stands has no course: the one before goes on.
    change = np.where(
        np.minimum(speed[:, 1:], speed[:, :-1]) > SLOW, np.angle(np.exp(1j * np.diff(course, axis=1))), 0.0
    )
    path = np.cumsum(change, axis=1)
    turned = path.max(axis=1, initial=0.0) - path.min(axis=1, initial=0.0)
    stopped = (speed < SLOW).mean(axis=1)
    return np.select(
        [stopped > STOPPED, turned > TURN, speed.mean(axis=1) > FAST], ["stop", "turn", "fast"], "straight"
    )

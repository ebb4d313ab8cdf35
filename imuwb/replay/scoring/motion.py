"""The kind of motion of the vehicle in an outage, from the reference."""

import numpy as np
from numpy.typing import NDArray

from imuwb.replay.replay import Replay

SLOW = 1.0  #: m/s; a slower vehicle counts as standing and has no course
STOPPED = 0.3  #: share of an outage; a vehicle that stands for longer makes it a "stop"
TURN = np.radians(45)  #: change of course that makes an outage a turn
FAST = 70 / 3.6  #: m/s, mean speed that makes an outage fast


def motion_classes(replay: Replay, duration: float) -> NDArray[np.str_]:
    """Return "stop", "turn", "fast" or "straight" for each outage of a duration, (s,)."""
    drift = next(iter(replay.runs.values())).outages[duration].drift
    velocity = replay.reference.at(np.concatenate([drift.start[:, None], drift.time], axis=1))[1]
    speed = np.hypot(velocity[..., 0], velocity[..., 1])
    course = np.arctan2(velocity[..., 1], velocity[..., 0])
    change = np.where(
        np.minimum(speed[:, 1:], speed[:, :-1]) > SLOW, np.angle(np.exp(1j * np.diff(course, axis=1))), 0.0
    )
    path = np.cumsum(change, axis=1)
    turned = path.max(axis=1, initial=0.0) - path.min(axis=1, initial=0.0)
    stopped = (speed < SLOW).mean(axis=1)
    return np.select(
        [stopped > STOPPED, turned > TURN, speed.mean(axis=1) > FAST], ["stop", "turn", "fast"], "straight"
    )

"""Tells several sensors whose rows take turns, at equal stamps, from one sensor with several samples of one stamp."""

import numpy as np

from imuwb.arrays import Floats, step_range
from imuwb.log import Nanoseconds

MOST = 8  #: sensors
NEARLY_ALL = 0.98  #: least share of the stamps that have equally many rows
FEWEST = 20  #: stamps; fewer do not show a difference
APART = 12.0  #: standard errors; the means of the samples of one sensor do not differ by so much


def sensors_in_turn(time: Nanoseconds, columns: dict[str, Floats]) -> int:
    """Return how many sensors take turns in the rows of a stream; 1 for a single sensor.

    The first, second and further rows of all stamps are then different sensors, with biases of their own.

    Args:
        time: (n,) ns, not falling.
        columns: the values of the rows.
    """
    if time.size < FEWEST or step_range(time)[0] > 0:
        return 1  # nearly all logs: each row has a stamp of its own
    starts = np.flatnonzero(np.diff(time, prepend=time[0] - 1))
    if starts.size < FEWEST or time.size < 2 * starts.size * NEARLY_ALL:
        return 1
    counts = np.diff(starts, append=time.size)
    usual = int(np.median(counts))
    whole = starts[counts == usual]
    if not 2 <= usual <= MOST or whole.size < NEARLY_ALL * starts.size:  # noqa: PLR2004 - two take turns
        return 1
    for values in columns.values():
        for turn in range(1, usual):
            apart = values[whole + turn] - values[whole]
            error = apart.std(axis=0) / np.sqrt(whole.size)
            if (np.abs(apart.mean(axis=0)) > APART * error).any():
                return usual
    return 1


def turns(time: Nanoseconds, sensors: int) -> Nanoseconds:
    """Return the turn of each row among those of its stamp, (n,), from 0."""
    first = np.flatnonzero(np.diff(time, prepend=time[0] - 1))
    counts = np.diff(first, append=time.size)
    return (np.arange(time.size) - np.repeat(first, counts)) % sensors

"""The staircase of a rate table: which given rate each step of the gyro's output belongs to."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats

TURNS = 0.3  #: share of the turned axis's span; an axis with a larger span turns as well
OFF = 0.01  #: share of the span of rates, by which a step may miss the line
GAINS = (0.5, 2.0)  #: smallest and largest plausible gain of a gyro in SI


@dataclass(frozen=True, eq=False, slots=True)
class Staircase:
    """The steps of one run, matched to the rates of the table."""

    axis: int  #: number of the gyro that turns
    rate: Floats  #: (k,) rad/s, given rate of each step


def turned_axis(mean: Floats, name: str) -> int:
    """Return the number of the gyro that turns.

    Args:
        mean: (k, 3) means of the steps.
        name: name of the run, for messages.

    Raises:
        ValueError: a second gyro turns as well.
    """
    span = np.ptp(mean, axis=0)
    axis = int(np.argmax(span))
    other = int(np.argsort(span)[1])
    if span[other] > TURNS * span[axis]:
        raise ValueError(
            f"{name}: gyro {'xyz'[axis]} and gyro {'xyz'[other]} both turn (their steps span {span[axis]:.3g} and {span[other]:.3g}); "
            "mount one axis of the sensor along the axis of the table"
        )
    return axis


def matched(mean: Floats, rates: Sequence[float], name: str, *, raw: bool) -> Staircase:
    """Return the given rate of each step, by the order of the levels.

    The steps may include both directions or one, and stops or none; the combination that fits a line best is taken.

    Args:
        mean: (k, 3) means of the steps, rad/s, counts or volts.
        rates: magnitudes of the table's rates, rad/s.
        name: name of the run, for messages.
        raw: whether the unit is not rad/s, so that the gain is not known.

    Raises:
        ValueError: two axes turn, or the steps do not match the given rates.
    """
    axis = turned_axis(mean, name)
    steps = mean[:, axis]
    wanted = np.unique(np.abs(np.asarray(rates, dtype=np.float64)))
    wanted = wanted[wanted > 0]
    fits = [fit for levels in _level_sets(wanted) if (fit := _fit(steps, levels, raw=raw)) is not None]
    if not fits:
        raise ValueError(
            f"{name}: the steps of gyro {'xyz'[axis]} do not match the given rates; tried: one or both directions, with and without a stop"
        )
    _, rate = min(fits, key=lambda fit: fit[0])
    return Staircase(axis, rate)


def _level_sets(wanted: Floats) -> list[Floats]:
    """Return the sets of levels that a run may have: both directions or one, with a stop or without."""
    up, down, stop = wanted, -wanted[::-1], np.zeros(1)
    parts = [(down, stop, up), (down, up), (stop, up), (down, stop), (up,), (down,)]
    return [np.concatenate(part) for part in parts if sum(map(len, part)) > 1]


def _fit(steps: Floats, levels: Floats, *, raw: bool) -> tuple[float, Floats] | None:
    """Return the largest distance of a step from the line, as a share of the span, and each step's rate; None: no fit."""
    gap = float(np.diff(levels).min()) / float(np.ptp(levels)) * float(np.ptp(steps))
    order = np.argsort(steps)
    cluster = np.concatenate([[0], np.cumsum(np.diff(steps[order]) > gap / 3)])
    if cluster[-1] + 1 != levels.size:
        return None
    rate = np.empty(steps.size)
    rate[order] = levels[cluster]
    gain, offset = np.polyfit(rate, steps, 1)
    worst = float(np.abs(steps - gain * rate - offset).max() / (abs(gain) * np.ptp(levels)))
    if worst > OFF or (not raw and not GAINS[0] < gain < GAINS[1]):
        return None
    return worst, rate

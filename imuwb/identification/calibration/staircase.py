"""The staircase of a rate table: which step of the gyro's output is which of the given rates."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

TURNS = 0.3  #: of the turned axis's span: another axis that spans more turns as well
OFF = 0.01  #: of the span of rates, by which a step may miss the line
GAINS = (0.5, 2.0)  #: of a gyro in SI


@dataclass(frozen=True, eq=False, slots=True)
class Staircase:
    """Steps of one run, matched to the table's rates."""

    axis: int  #: which gyro turns
    rate: Floats  #: (k,) rad/s, of each step, as given
    both: bool  #: both directions occur


def turned_axis(mean: Floats, name: str) -> int:
    """Return which gyro turns.

    Args:
        mean: (k, 3) means of the steps.
        name: of the run, for messages.

    Raises:
        ValueError: two turn alike.
    """
    span = np.ptp(mean, axis=0)
    axis = int(np.argmax(span))
    other = int(np.argsort(span)[1])
    if span[other] > TURNS * span[axis]:
        message = (
            f"{name}: gyro {'xyz'[axis]} and gyro {'xyz'[other]} both turn (their steps span {span[axis]:.3g} and {span[other]:.3g}); "
            "mount one axis along the table's"
        )
        raise ValueError(message)
    return axis


def matched(mean: Floats, rates: Sequence[float], name: str, *, raw: bool) -> Staircase:
    """Return which given rate each step is, by the order of the levels.

    The given rates may occur in both directions or in one, and with stops or without; what fits a line best is taken.

    Args:
        mean: (k, 3) means of the steps, rad/s, or counts or volts.
        rates: magnitudes, rad/s.
        name: of the run, for messages.
        raw: the unit is not rad/s, so that the gain is not known.

    Raises:
        ValueError: two axes turn, or the steps are not the given rates.
    """
    axis = turned_axis(mean, name)
    steps = mean[:, axis]
    wanted = np.unique(np.abs(np.asarray(rates, dtype=np.float64)))
    wanted = wanted[wanted > 0]
    fits = [found for levels in _candidates(wanted) if (found := _fit(steps, levels, raw=raw)) is not None]
    if not fits:
        message = f"{name}: the steps of gyro {'xyz'[axis]} are not the given rates, in both directions or one, with stops or without"
        raise ValueError(message)
    _, rate = min(fits, key=lambda fit: fit[0])
    return Staircase(axis, rate, bool(rate.min() < 0 < rate.max()))


def _candidates(wanted: Floats) -> list[Floats]:
    up, down, stop = wanted, -wanted[::-1], np.zeros(1)
    parts = [(down, stop, up), (down, up), (stop, up), (down, stop), (up,), (down,)]
    return [np.concatenate(part) for part in parts if sum(map(len, part)) > 1]


def _fit(steps: Floats, levels: Floats, *, raw: bool) -> tuple[float, Floats] | None:
    """Return how far the steps are off the line at most, as a share of the span, and the rate of each; None: they do not fit."""
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

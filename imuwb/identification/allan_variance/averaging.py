"""The averaging times of a curve: octaves, evenly spaced on a log axis, all, or a list."""

from collections.abc import Sequence

import numpy as np

from imuwb.arrays import Integers

MOST_TIMES = 10_000  #: largest N of log:N
MOST_WORK = 10**11  #: largest number of second differences; so many take about a minute


def averaging_factors(times: str | Sequence[float], n: int, dt: float) -> Integers:
    """Return averaging factors m (tau = m dt) in rising order for n samples; each is at most n/2.

    Args:
        times: ``"octave"`` (m = 1, 2, 4, ...), ``"log:N"`` (about N times), ``"all"``, or times in s as numbers or as a
            text with commas; each is rounded to a multiple of dt.
        n: number of samples.
        dt: s.

    Raises:
        ValueError: a text that is none of these, or no time between dt and half the record.
    """
    largest = n // 2
    if largest < 1:
        raise ValueError(f"{n} samples are too few for an Allan variance; it needs at least 2")
    if not isinstance(times, str):
        return _listed(times, largest, dt)
    if times == "octave":
        return 2 ** np.arange(int(np.log2(largest)) + 1)
    if times == "all":
        if n * n / 4 > MOST_WORK:
            raise ValueError(
                f"all {largest} averaging times of {n} samples would take minutes to hours; write log:1000 instead"
            )
        return np.arange(1, largest + 1)
    kind, _, number = times.partition(":")
    if kind == "log" and number.isdecimal() and 1 < int(number) <= MOST_TIMES:
        return np.unique(np.rint(np.geomspace(1, largest, int(number))).astype(np.int64))
    try:
        return _listed([float(part) for part in times.split(",")], largest, dt)
    except ValueError as error:
        raise ValueError(
            f"averaging times {times!r}: {error}; write octave, log:90, all, or seconds such as 0.1,1,10"
        ) from error


def _listed(times: Sequence[float], largest: int, dt: float) -> Integers:
    seconds = np.asarray(times, dtype=np.float64)
    if not np.isfinite(seconds).all():
        raise ValueError("an averaging time is not finite")
    factors = np.unique(np.rint(np.clip(seconds / dt, 0, 2**53)).astype(np.int64))
    inside = factors[(factors >= 1) & (factors <= largest)]
    if not inside.size:
        raise ValueError(f"no averaging time is between {dt:g} s (one sample) and {largest * dt:g} s (half the record)")
    return inside

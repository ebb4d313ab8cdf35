"""Steady stretches of a record: positions of an accelerometer, steps of a staircase of rates."""

from collections.abc import Sequence

import numpy as np

from imuwb.arrays import Floats
from imuwb.sampling import runs

BLOCK = 0.5  #: s, length of a block
FEWEST = 8  #: least number of samples in a block
QUARTER = 0.3186393639643751  #: standard deviations; a quarter of all normal deviations are smaller
JUMP = 7.0  #: standard deviations between the means of neighbouring blocks, from which the sensor moved
SCATTER = 3.0  #: ratio to the usual scatter within a block, from which the sensor moved
DRIFT = 0.01  #: share of the span; a stretch whose halves differ by more is not steady
ROUNDED = 1e-9  #: share of the span; smaller differences are rounding errors


def steady(
    values: Floats, dt: float, shortest: float, span: Floats, tolerance: Floats | float = 0.0
) -> list[tuple[int, int]]:
    """Return the rows (first, end) of each stretch in which all channels are constant except for noise.

    Neighbouring blocks of half a second belong together if their means differ by no more than noise. The size of the noise is
    estimated from the smallest quarter of the differences. The first and last block of a stretch, which may include a
    transition, are left out.

    Args:
        values: (n, k), evenly sampled, without gaps.
        dt: s.
        shortest: s, least duration of a stretch.
        span: (k,) range of each channel, in its unit; a slow drift is compared with it.
        tolerance: (k,) difference between two blocks that is allowed in addition to noise, since a hand is never quite still.
    """
    size = max(round(BLOCK / dt), FEWEST)
    count = len(values) // size
    if count < 4:  # noqa: PLR2004 - two inner blocks, and one to leave out at each end
        return []
    blocks = values[: count * size].reshape(count, size, -1)
    mean, scatter = blocks.mean(axis=1), blocks.std(axis=1)
    steps = np.abs(np.diff(mean, axis=0))
    still = np.quantile(scatter, 0.25, axis=0)
    # A quarter of few differences may be small by chance; the scatter within blocks gives a lower bound.
    usual = np.maximum(np.quantile(steps, 0.25, axis=0) / QUARTER, still * (2 / size) ** 0.5)
    calm = (steps <= np.maximum(JUMP * usual, tolerance) + ROUNDED * span).all(axis=1)
    quiet = (scatter <= np.maximum(SCATTER * still, tolerance) + ROUNDED * span).all(axis=1)
    # A block and the block before it belong together.
    joined = calm & quiet[1:] & quiet[:-1]
    stretches: list[tuple[int, int]] = []
    for first, steps_joined in zip(*runs(joined), strict=True):
        # blocks first ... end belong together; both outer blocks are left out
        begin, end = int(first) + 1, int(first + steps_joined)
        if (end - begin) * size * dt >= shortest and _level(mean[begin:end], span):
            stretches.append((begin * size, end * size))
    return stretches


def _level(mean: Floats, span: Floats) -> bool:
    half = len(mean) // 2
    return half == 0 or bool((np.abs(mean[:half].mean(axis=0) - mean[-half:].mean(axis=0)) <= DRIFT * span).all())


def shared(a: Sequence[tuple[float, float]], b: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Return the spans of time that are in both lists; each list is sorted and its spans do not overlap."""
    common: list[tuple[float, float]] = []
    i = j = 0
    while i < len(a) and j < len(b):
        begin, end = max(a[i][0], b[j][0]), min(a[i][1], b[j][1])
        if begin < end:
            common.append((begin, end))
        if a[i][1] < b[j][1]:
            i += 1
        else:
            j += 1
    return common

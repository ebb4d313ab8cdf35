"""Where a record stays as it is: positions of an accelerometer, steps of a staircase of rates."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

BLOCK = 0.5  #: s
FEWEST = 8  #: samples of a block
QUARTER = 0.3186393639643751  #: of a standard deviation: what a quarter of normal deviations stay within
JUMP = 7.0  #: standard deviations between two blocks' means that are no noise
SCATTER = 3.0  #: times the usual scatter within a block, likewise
DRIFT = 0.01  #: of the span: a stretch whose halves differ by more is no steady one
ROUNDED = 1e-9  #: of the span: what rounding makes of numbers


def steady(
    values: Floats, dt: float, shortest: float, span: Floats, tolerance: Floats | float = 0.0
) -> list[tuple[int, int]]:
    """Return the rows (first, end) of each stretch in which all channels stay as they are, but for noise.

    Blocks of half a second are joined while their means differ by noise; what noise is, the quietest quarter of the
    differences tells. The first and last block of a stretch, where it may still settle, are left out.

    Args:
        values: (n, k), evenly sampled, without gaps.
        dt: s.
        shortest: s, of a stretch.
        span: (k,) what a channel may reach, in its unit, against which a slow drift is judged.
        tolerance: (k,) by how much two blocks may differ whatever the noise: a hand is never quite still.
    """
    size = max(round(BLOCK / dt), FEWEST)
    count = len(values) // size
    if count < 4:  # noqa: PLR2004 - two differences, and an end to leave out on both sides
        return []
    blocks = values[: count * size].reshape(count, size, -1)
    mean, scatter = blocks.mean(axis=1), blocks.std(axis=1)
    steps = np.abs(np.diff(mean, axis=0))
    still = np.quantile(scatter, 0.25, axis=0)
    # A quarter of few differences may be small by chance: never less than what white noise within blocks makes of them.
    usual = np.maximum(np.quantile(steps, 0.25, axis=0) / QUARTER, still * (2 / size) ** 0.5)
    calm = (steps <= np.maximum(JUMP * usual, tolerance) + ROUNDED * span).all(axis=1)
    quiet = (scatter <= np.maximum(SCATTER * still, tolerance) + ROUNDED * span).all(axis=1)
    # A block belongs to a stretch with the block before it.
    joined = calm & quiet[1:] & quiet[:-1]
    edges = np.flatnonzero(np.diff(np.concatenate([[False], joined, [False]])))
    found: list[tuple[int, int]] = []
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        begin, end = int(first) + 1, int(last)  # blocks first ... last belong together; the outer ones are left out
        if (end - begin) * size * dt >= shortest and _level(mean[begin:end], span):
            found.append((begin * size, end * size))
    return found


def _level(mean: Floats, span: Floats) -> bool:
    half = len(mean) // 2
    return half == 0 or bool((np.abs(mean[:half].mean(axis=0) - mean[-half:].mean(axis=0)) <= DRIFT * span).all())


def shared(a: Sequence[tuple[float, float]], b: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Return the spans of time that lie in a span of both lists, each sorted and without overlaps."""
    found: list[tuple[float, float]] = []
    i = j = 0
    while i < len(a) and j < len(b):
        begin, end = max(a[i][0], b[j][0]), min(a[i][1], b[j][1])
        if begin < end:
            found.append((begin, end))
        if a[i][1] < b[j][1]:
            i += 1
        else:
            j += 1
    return found

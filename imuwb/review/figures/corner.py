"""The corner of a chart in which a legend hides the least of its lines."""

from typing import Literal, TypeAlias

import numpy as np

from imuwb.arrays import Floats, Integers

Corner: TypeAlias = Literal["LeftTop", "RightTop", "RightBottom", "LeftBottom"]

PLACES = 100  #: across the chart at which lines are looked at
CORNERS: dict[Corner, tuple[bool, bool]] = {  #: whether it is at the right, and at the top; the first of equal ones is taken
    "LeftTop": (False, True), "RightTop": (True, True), "RightBottom": (True, False), "LeftBottom": (False, False),
}  # fmt: skip


def free_corner(
    time: Integers, values: Floats, shown: tuple[int, int], limits: tuple[float, float] | None, size: tuple[float, float]
) -> tuple[Corner, int]:  # fmt: skip
    """Return the corner in which a legend hides the least of the lines, and how many of their places it hides there.

    Args:
        time: (n,) ns, rising.
        values: (n, k), a line each; NaN interrupts it.
        shown: the first and the last time that the chart shows, ns.
        limits: of the values; None: those of the values that it shows.
        size: width and height of the legend, as shares of the chart.
    """
    at = np.linspace(0.0, 1.0, PLACES)
    when = shown[0] + at * (shown[1] - shown[0])
    drawn = np.stack([np.interp(when, time, own, np.nan, np.nan) for own in values.T], axis=1)
    if not np.isfinite(drawn).any():
        return "LeftTop", 0
    low, high = limits or (float(np.nanmin(drawn)), float(np.nanmax(drawn)))
    up = (drawn - low) / ((high - low) or 1.0)
    width, height = size

    def hidden(corner: Corner) -> int:
        right, top = CORNERS[corner]
        beside = at >= 1 - width if right else at <= width
        return int((beside[:, None] & ((up >= 1 - height) if top else (up <= height))).sum())

    best = min(CORNERS, key=hidden)
    return best, hidden(best)

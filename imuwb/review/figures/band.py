"""The band of a curve, between its lower and its upper ends: the viewer fills no area in two dimensions, so columns fill it."""

import numpy as np

from imuwb.analysis import Curve
from imuwb.colors import BACKGROUND, between
from imuwb.review.figures.drawing import Drawing
from imuwb.review.figures.frame import Frame, Point

COLUMN = 4.0  #: width of a column, in the view's units
SHARE = 0.16  #: of the curve's colour in the band; the rest is the background's


def band(curve: Curve, frame: Frame, sheet: Drawing, name: str, order: float) -> None:
    """Draw a band; between two points its ends are straight lines in the frame."""
    if curve.lower is None or curve.upper is None:
        return
    known = np.isfinite(curve.lower) & np.isfinite(curve.upper)
    x = np.array([frame.width * frame.x.position(v) if frame.x.shows(v) else np.nan for v in curve.x[known]])
    ends = [
        [frame.y.position(v) if frame.y.shows(v) else 0.0 for v in part[known]] for part in (curve.lower, curve.upper)
    ]
    at = np.arange(max(np.nanmin(x), 0.0), min(np.nanmax(x), frame.width), COLUMN) if x.size > 1 else np.empty(0)
    low, high = (np.clip(np.interp(at, x, end), 0.0, 1.0) for end in ends)
    columns: list[list[Point]] = [
        [(float(a), frame.height * (1 - float(b))), (float(a), frame.height * (1 - float(c)))]
        for a, b, c in zip(at + COLUMN / 2, low, high, strict=True)
        if c > b
    ]
    if columns:
        color = between(BACKGROUND, curve.color, SHARE)
        sheet.area(name, columns, [color] * len(columns), COLUMN / 2, order)

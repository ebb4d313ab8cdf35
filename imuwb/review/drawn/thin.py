"""What an analysis has drawn, with no more points than a figure on a page shows: no peak is lost."""

from dataclasses import replace

import numpy as np

from imuwb.analysis import Curve, Figure, Series
from imuwb.arrays import Floats, Integers
from imuwb.review.drawn.calls import Drawn, Item, Track
from imuwb.review.drawn.envelope import envelope

COLUMNS = 200  #: of a curve; each has at most its smallest and its largest point
ROWS = 120  #: of a cloud of points; each cell of the grid has one
SPANS = 300  #: of a series
PLACES = 300  #: of a track


def thin(drawn: Drawn) -> Drawn:
    """Return what was drawn with few points."""
    return Drawn(drawn.tab, _item(drawn.item))


def thin_figure(figure: Figure) -> Figure:
    """Return a figure whose curves have few points."""
    across = _range([curve.x for curve in figure.curves], figure.x_scale)
    up = _range([curve.y for curve in figure.curves], figure.y_scale)
    return replace(figure, curves=tuple(_curve(curve, figure, across, up) for curve in figure.curves))


def _item(item: Item) -> Item:
    if isinstance(item, Figure):
        return thin_figure(item)
    if isinstance(item, Series):
        time, values = envelope(np.asarray(item.time), np.asarray(item.values, float), SPANS)
        return replace(item, time=time, values=values)
    if isinstance(item, Track):
        whole = np.asarray(item.position, float)
        kept = (
            np.unique(np.linspace(0, len(whole) - 1, min(len(whole), PLACES)).astype(int)) if len(whole) else slice(0)
        )
        return replace(item, position=whole[kept])
    return item


def _curve(curve: Curve, figure: Figure, across: tuple[float, float], up: tuple[float, float]) -> Curve:
    x, y = np.asarray(curve.x, float), np.asarray(curve.y, float)
    if x.size <= 2 * COLUMNS:
        return curve
    column = _cells(x, figure.x_scale, across, COLUMNS)
    if curve.style == "points":
        cell = column * ROWS + _cells(y, figure.y_scale, up, ROWS)
        kept = np.unique(cell, return_index=True)[1]
    else:
        kept = _peaks(column, y)
    kept.sort()
    low, high = (None if part is None else np.asarray(part, float)[kept] for part in (curve.lower, curve.upper))
    return replace(curve, x=x[kept], y=y[kept], lower=low, upper=high)


def _peaks(column: Integers, y: Floats) -> Integers:
    """Return the indices of the smallest and the largest value of each run of one column, and of both ends."""
    begins = np.diff(column, prepend=column[0] - 1) != 0
    starts, run = np.flatnonzero(begins), np.cumsum(begins)
    smallest, largest = (np.lexsort((np.where(np.isfinite(y), sign * y, np.inf), run))[starts] for sign in (1, -1))
    return np.unique(np.concatenate([[0], smallest, largest, [y.size - 1]]))


def _range(parts: list[Floats], scale: str) -> tuple[float, float]:
    values = np.concatenate([np.asarray(part, float).ravel() for part in parts]) if parts else np.empty(0)
    values = values[np.isfinite(values) & ((values > 0) | (scale != "log"))]
    return (float(values.min()), float(values.max())) if values.size else (1.0, 1.0)


def _cells(values: Floats, scale: str, ends: tuple[float, float], count: int) -> Integers:
    """Return the cell of each value on an axis; a value that the axis does not have is in a cell of its own."""
    low, high = ends
    if scale == "log":
        with np.errstate(divide="ignore", invalid="ignore"):
            values = np.log(values)
        low, high = np.log(low), np.log(high)
    share = (values - low) / ((high - low) or 1.0)
    return np.where(np.isfinite(share), np.clip(share * count, 0, count - 1), count).astype(np.int64)

"""The charts of a tab: quantities over time. Long series are drawn as the envelopes of their extremes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from imuwb.analysis import Series
from imuwb.arrays import Floats, Integers
from imuwb.review.drawn.envelope import envelope
from imuwb.review.figures.corner import Corner, free_corner
from imuwb.review.figures.sizes import LEGEND_ROW, text_width
from imuwb.review.figures.value_axis import value_range
from imuwb.review.scene.shading import Chart
from imuwb.review.scene.timelines import Timelines
from imuwb.texts import printable

WIDTH = 1.2  #: width of a line
LOW_STEPS = 7  #: steps that have labels in the low charts beside a scene
NARROWEST, LOWEST = 260.0, 105.0  #: width and height of the field of a chart beside a scene, px
LEGEND_AIR = 45.0  #: what the width of a legend has besides its texts, px
FEW_NAMES, ROOM = 2, 0.6  #: names of a short legend, and the share of a chart's height that it takes
WHOLE = rr.TimeRange(start=rr.TimeRangeBoundary.infinite(), end=rr.TimeRangeBoundary.infinite())


@dataclass(frozen=True, eq=False, slots=True)
class _Drawn:
    """A series with the rows that are drawn."""

    series: Series
    time: Integers  #: (n,) ns
    values: Floats  #: (n, k)


def charts(
    all_series: Sequence[Series], recording: rr.RecordingStream, timelines: Timelines, path: str, *, beside: bool,
    plain: bool,
) -> Iterator[tuple[rrb.View, Chart]]:  # fmt: skip
    """Log series below an entity path, and yield the view of each and what it shows.

    Args:
        all_series: of the tab.
        recording: where they are logged.
        timelines: of the recording.
        path: of the tab.
        beside: whether the charts are beside a scene, where there is little room.
        plain: whether nothing is shaded in all charts.
    """
    drawn = [_Drawn(series, *envelope(series.time, series.values)) for series in all_series]
    across = _across(drawn, timelines)
    for first, group in _groups(drawn, plain=plain):
        own = f"{path}/series_{first}"
        _log(group, recording, timelines, own, beside=beside)
        for number, one in enumerate(group):
            shown = [number == k for k in range(len(group))] if len(group) > 1 else []
            limits = _limits(one, timelines, beside=beside, growing=first == 0)
            corner: Corner = "RightTop"
            if beside:
                corner, limits = _placed(one, timelines, limits, growing=first == 0)
            yield (
                _view(one, own, shown, (across, limits), corner),
                Chart(own, one.time, one.values, one.series.spans, limits),
            )


def _groups(drawn: Sequence[_Drawn], *, plain: bool) -> Iterator[tuple[int, list[_Drawn]]]:
    """Yield series that are logged as one entity, which saves room: those of one quantity each at the same times.

    Each has a chart of its own, in which the others are hidden. A legend would name the hidden ones too, and what is shaded belongs
    to one chart, so only a chart that has neither is in a group.
    """
    group: list[_Drawn] = []
    for number, one in enumerate(drawn):
        alone = not plain or bool(one.series.spans) or one.values.shape[1] != 1
        if group and (alone or not np.array_equal(one.time, group[0].time)):
            yield number - len(group), group
            group = []
        group = [*group, one]
        if alone:
            yield number, group
            group = []
    if group:
        yield len(drawn) - len(group), group


def _log(
    group: Sequence[_Drawn], recording: rr.RecordingStream, timelines: Timelines, path: str, *, beside: bool
) -> None:
    names = [f"{name}{'' if beside else f' [{one.series.unit}]'}" for one in group for name in one.series.names]
    colors = [color for one in group for color in one.series.colors]
    style = rr.SeriesLines(
        names=names, colors=colors if len(colors) == len(names) else None, widths=[WIDTH] * len(names),
        aggregation_policy=rr.components.AggregationPolicy.MinMax,
    )  # fmt: skip
    recording.log(path, style, static=True)
    values = np.concatenate([one.values for one in group], axis=1)
    timelines.rows(
        path,
        group[0].time,
        lambda rows: rr.Scalars.columns(scalars=values[rows].ravel()).partition([values.shape[1]] * rows.size),
    )


def _limits(one: _Drawn, timelines: Timelines, *, beside: bool, growing: bool) -> tuple[float, float] | None:
    """Return the limits of a chart's values, with which the viewer labels two ticks; None: the viewer chooses them.

    Beside a scene a person looks at one window at a time: the limits are those of the values in all of them. An error that grows is
    small in one and large in another, so the viewer chooses its limits for each.
    """
    if not beside:
        return value_range(one.values)
    inside = np.zeros(one.time.size, dtype=bool)
    for window in timelines.windows:
        inside |= window.holds(one.time)
    return None if growing else value_range(one.values[inside], LOW_STEPS)


def _across(drawn: Sequence[_Drawn], timelines: Timelines) -> rr.TimeRange:
    """Return the times that all charts of a tab show: those of their own log, which may be one of several on the timeline."""
    ends = [end for one in drawn if one.time.size for end in (int(one.time.min()), int(one.time.max()))]
    if timelines.windows or not ends or min(ends) == max(ends):
        return WHOLE
    begin, end = (rr.TimeRangeBoundary.absolute(nanos=own) for own in (min(ends), max(ends)))
    return rr.TimeRange(start=begin, end=end)


def _placed(
    one: _Drawn, timelines: Timelines, limits: tuple[float, float] | None, *, growing: bool
) -> tuple[Corner, tuple[float, float] | None]:  # fmt: skip
    """Return the corner of the legend of a chart beside a scene, and the chart's limits, which leave a short legend room above the lines."""
    if not one.time.size:
        return "LeftTop", limits
    windows = timelines.windows
    shown = (int(one.time[0]), int(one.time[-1])) if not windows else (windows[0].begin, windows[0].end)
    names = {*one.series.names}
    width = (max(map(text_width, names), default=0.0) + LEGEND_AIR) / NARROWEST
    height = LEGEND_ROW * (len(names) + 1) / LOWEST  # a row more, for what is shaded
    size = (min(width, 1.0), min(height, 1.0))
    corner, hidden = free_corner(one.time, one.values, shown, limits, size)
    if not hidden or growing or len(names) > FEW_NAMES:
        return corner, limits
    inside = one.values[np.logical_or.reduce([w.holds(one.time) for w in windows])] if windows else one.values
    if not np.isfinite(inside).any():  # the window lies between two rows
        return corner, limits
    low, top = float(np.nanmin(inside)), float(np.nanmax(inside))
    low, high = limits or (low, top)
    return "LeftTop", (low, max(high, low + (top - low) / (1 - ROOM)))


def _view(
    one: _Drawn, path: str, shown: Sequence[bool], limits: tuple[rr.TimeRange, tuple[float, float] | None], corner: Corner
) -> rrb.View:  # fmt: skip
    """Return the view of a chart; ``shown`` tells which lines of its entity it shows, if not all; ``limits``: of times and of values."""
    across, stated = limits
    legend = rrb.PlotLegend(corner=corner, visible=len(one.series.names) > 1)
    return rrb.TimeSeriesView(
        origin=path, name=printable(f"{one.series.title} [{one.series.unit}]"), axis_x=rrb.TimeAxis(view_range=across),
        axis_y=None if stated is None else rrb.ScalarAxis(range=stated), plot_legend=legend,
        overrides={path: [rr.SeriesLines.from_fields(visible_series=list(shown))]} if shown else None,
    )  # fmt: skip

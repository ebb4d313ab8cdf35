"""Spans and events in the charts of a tab: a span as a shaded field, an event as a vertical line.

The viewer has no shaded spans, so a span is a row of wide, almost transparent vertical lines that reach over the values near it.
Their width is in points of the screen: on a usual screen they touch each other.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from rerun.blueprint.encodings import TextLogColumn

from imuwb.arrays import Floats, Integers
from imuwb.colors import GREY, ORANGE, RED, Color
from imuwb.review.scene.timelines import Columns, Timelines, Window
from imuwb.scene import Event, Level, Span

WIDTH = 850.0  #: width of a chart beside a scene on a screen of 1920 points
STROKES = 30  #: lines of a span on the timeline of a window
SLIM = 5.0  #: width of the lines of a span on the timeline of the whole log, points of the screen
MARK = 1.5  #: width of an event's line
OPACITY = 45
OVERLAP = 1.05  #: width of a line over the distance between two
COLORS: dict[Level, Color] = {"note": GREY, "warning": ORANGE, "fault": RED}
LEVELS: dict[Level, str] = {"note": "INFO", "warning": "WARN", "fault": "ERROR"}


@dataclass(frozen=True, eq=False, slots=True)
class Chart:
    """The values that a chart shows."""

    path: str
    time: Integers  #: (n,) ns
    values: Floats  #: (n, k)
    spans: tuple[Span, ...] = ()  #: of this chart alone
    limits: tuple[float, float] | None = None  #: of the values that are visible; None: the viewer chooses them

    def range(self, begin: int, end: int) -> tuple[float, float] | None:
        """Return the visible limits, or the least and the largest value between two times, or of all if there is none; None: no value."""
        if self.limits is not None:
            return self.limits
        inside = self.values[(self.time >= begin) & (self.time <= end)]
        for values in (inside, self.values):
            known = values[np.isfinite(values)]
            if known.size:
                return float(known.min()), float(known.max())
        return None


def shade(
    chart: Chart, spans: Sequence[Span], events: Sequence[Event], recording: rr.RecordingStream, timelines: Timelines
) -> None:
    """Draw spans and events into a chart; notes are in the list alone."""
    events = [event for event in events if event.level != "note"]
    if not (spans or events) or not chart.time.size:
        return
    lines = _Lines([*dict.fromkeys(span.text for span in spans)], [*dict.fromkeys(event.level for event in events)])
    whole = Window("", int(chart.time.min()), 0, int(chart.time.max()))
    windows = timelines.windows
    wide = max((WIDTH / (w.end - w.begin) for w in windows), default=0.0)  # points per ns
    longest = max((span.end - span.begin for span in spans), default=0)
    path = f"{chart.path}/spans"
    recording.log(path, lines.style(spans, OVERLAP * wide * longest / STROKES), static=True)
    for window in (whole, *windows):
        rows = list(lines.rows(chart, spans, events, window))
        if not rows:
            continue
        rows.sort(key=lambda row: row[:2])
        values = np.full((len(rows), lines.count), np.nan)
        for row, (_, column, value) in enumerate(rows):
            values[row, column] = value
        time = np.array([row[0] for row in rows], dtype=np.int64)
        timelines.rows(path, time, _scalars(values), (window.name,))


def _scalars(values: Floats) -> Columns:
    return lambda rows: rr.Scalars.columns(scalars=values[rows].ravel()).partition([values.shape[1]] * rows.size)


@dataclass(frozen=True, slots=True)
class _Lines:
    """The lines of spans and events: for each text a wide and a slim line, and one for each level of events."""

    texts: list[str]
    levels: list[Level]

    @property
    def count(self) -> int:
        return 2 * len(self.texts) + len(self.levels)

    def style(self, spans: Sequence[Span], wide: float) -> rr.SeriesLines:
        """Return how the lines look; ``wide`` is the width of those in windows, points of the screen."""
        colors = [(*next(span.color for span in spans if span.text == text), OPACITY) for text in self.texts]
        return rr.SeriesLines(
            names=[*self.texts, *self.texts, *self.levels],
            colors=[*colors, *colors, *((*COLORS[level], 255) for level in self.levels)],
            widths=[wide] * len(colors) + [SLIM] * len(colors) + [MARK] * len(self.levels),
            aggregation_policy=rr.components.AggregationPolicy.Off,
        )  # fmt: skip

    def rows(
        self, chart: Chart, spans: Sequence[Span], events: Sequence[Event], window: Window
    ) -> Iterator[tuple[int, int, float]]:
        """Yield time, number of the line, and value of all vertices in a window; NaN ends a vertical line."""
        for span in spans:
            begin, end = max(span.begin, window.begin), min(span.end, window.end)
            ends = chart.range(window.begin, window.end)
            if begin >= end or ends is None:
                continue
            share = (end - begin) / max(window.end - window.begin, 1)
            count = STROKES if window.name else max(1, round(WIDTH * share / SLIM))
            line = self.texts.index(span.text) + (0 if window.name else len(self.texts))
            for k in range(count):
                middle = begin + round((k + 0.5) * (end - begin) / count)
                yield from ((middle + i, line, value) for i, value in enumerate((*ends, np.nan)))
        for event in events:
            ends = chart.range(window.begin, window.end)
            if ends is not None and window.begin <= event.time <= window.end:
                line = 2 * len(self.texts) + self.levels.index(event.level)
                yield from ((event.time + i, line, value) for i, value in enumerate((*ends, np.nan)))


def event_list(events: Sequence[Event], timelines: Timelines, path: str) -> rrb.View:
    """Keep the events as lines of a log, and return its view."""
    ordered = sorted(events, key=lambda event: event.time)
    time = np.array([event.time for event in ordered], dtype=np.int64)
    texts = [f"{event.source}: {event.text}" for event in ordered]

    def columns(rows: Integers) -> object:
        chosen = rows.tolist()
        return rr.TextLog.columns(
            text=[texts[k] for k in chosen], level=[LEVELS[ordered[k].level] for k in chosen],
            color=[COLORS[ordered[k].level] for k in chosen],
        )  # fmt: skip

    timelines.rows(path, time, columns)
    shown = rrb.TextLogColumns(text_log_columns=[TextLogColumn("LogLevel"), TextLogColumn("Body")])
    return rrb.TextLogView(origin=path, name="Faults of the log", columns=shown)

"""Bars with their intervals in a 2D view: a name at the left, the value with its interval at the right."""

from __future__ import annotations

import rerun as rr
import rerun.blueprint as rrb

from imuwb.analysis import Bars
from imuwb.colors import GRID, INK
from imuwb.review.figures import drawing

WIDTH, STEP = 600.0, 46.0  #: px of the longest bar, and between two bars
NAME, VALUE = 8.0, 7.5  #: px of a letter of a name, and of a value
DROP = 11.0  #: px from a point to the middle of its label
HALF, AIR = 9.0, 24.0  #: px, half the width of a bar, and round all


def draw(bars: Bars, recording: rr.RecordingStream, path: str) -> rrb.View:
    """Log bars below an entity path, and return their view."""
    longest = max((max(bar.value, bar.upper or 0.0) for bar in bars.bars), default=0.0) or 1.0
    px = WIDTH / longest
    heights = [STEP * i for i in range(len(bars.bars))]
    strips = [[(0.0, y), (max(bar.value, 0.0) * px, y)] for bar, y in zip(bars.bars, heights, strict=True)]
    colors = [bar.color for bar in bars.bars]
    fields = [[(0.0, y), (WIDTH, y)] for y in heights]
    sheet = drawing.Drawing()
    sheet.line("fields", fields, [(*GRID, 90)] * len(fields), 0.5, 0)
    sheet.area("bars", strips, colors, HALF, 1)
    intervals = [
        [(max(bar.lower, 0.0) * px, y), (bar.upper * px, y)]
        for bar, y in zip(bars.bars, heights, strict=True)
        if bar.lower is not None and bar.upper is not None
    ]
    sheet.line("intervals", intervals, [INK] * len(intervals), 1.5, 2)
    left = right = 0.0
    for bar, y in zip(bars.bars, heights, strict=True):
        text, half = bar.text(bars.unit), NAME / 2 * len(bar.label)
        left, right = max(left, 2 * half), max(right, VALUE * len(text))
        places = [
            ((-AIR / 2 - half, y - DROP), bar.label),
            ((WIDTH + AIR / 2 + VALUE / 2 * len(text), y - DROP), text),
        ]
        sheet.text(bar.label, places, bar.color)
    sheet.log(recording, path)
    x_range = (-left - AIR, WIDTH + right + AIR)
    return drawing.plane_view(
        path, f"{bars.title} [{bars.unit}]", x_range, (-STEP, heights[-1] + STEP if heights else STEP)
    )

"""Figures of a page as SVG, through matplotlib: text stays text, colours follow the page's theme, ids are unique."""

import io
import math
import re
import textwrap
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure as Canvas

from imuwb.analysis import Curve, Figure, Series
from imuwb.arrays import Floats
from imuwb.colors import INK, PALE, Color
from imuwb.log import SECOND
from imuwb.review.drawn import Track
from imuwb.review.envelope import envelope
from imuwb.review.track import local_plane

SIZE = (7.2, 3.6)  #: inches
TRACK_SIZE = (7.2, 5.0)
POINTS = 150  #: of a curve
COLUMNS = 240  #: of a long series
TITLE = 44  #: letters of a line of an axis's title
MARKED = 40  #: points, up to which each has a marker
#: Colours that stand for those of the page, which the theme of the reader chooses.
_INK, _GRID = "#010203", "#040506"
_THEME = {_INK: "var(--ink)", _GRID: "var(--grid)"}
_STYLE: Any = {
    "svg.fonttype": "none", "svg.hashsalt": "imuwb", "font.size": 9, "font.family": "sans-serif", "axes.edgecolor": _INK,
    "axes.labelcolor": _INK, "xtick.color": _INK, "ytick.color": _INK, "text.color": _INK, "grid.color": _GRID, "axes.grid": True,
    "axes.titlesize": 10, "axes.titlelocation": "left", "legend.frameon": False, "legend.fontsize": 8, "axes.spines.top": False,
    "axes.spines.right": False, "figure.constrained_layout.use": True, "path.simplify_threshold": 0.5, "xtick.minor.visible": False,
    "ytick.minor.visible": False, "lines.linewidth": 1.2, "axes.unicode_minus": True,
}  # fmt: skip
_PLACES = re.compile(r' (?:d|points|transform|x|y|x1|y1|x2|y2|width|height)="[^"]*"')  #: never the texts
_NUMBER = re.compile(r"-?\d+\.\d{2,}")


@dataclass(frozen=True, slots=True)
class Picture:
    """An SVG element, and what it shows in words."""

    title: str
    svg: str


def figure_picture(figure: Figure, number: int) -> Picture:
    """Return a figure of an analysis; ``number`` makes the ids of its elements unique on the page."""
    with mpl.rc_context(_STYLE):
        canvas = Canvas(figsize=SIZE)
        axes = canvas.add_subplot()
        axes.set(
            xlabel=figure.x_title,
            ylabel="\n".join(textwrap.wrap(figure.y_title, TITLE)),
            xscale=figure.x_scale,
            yscale=figure.y_scale,
        )
        for curve in figure.curves:
            _draw(axes, curve)
        for vertical in figure.verticals:
            axes.axvline(vertical.x, color=_color(vertical.color), ls="--", lw=0.8, label=vertical.text or None)
        for mark in figure.marks:
            label = f"{mark.text}: {mark.y:.3g} at {mark.x:.3g}"
            axes.plot([mark.x], [mark.y], "D", ms=4, mec=_INK, mew=0.5, color=_color(mark.color), label=label)
        _limit(axes, figure)
        return Picture(figure.title, _svg(canvas, axes, number))


def series_picture(series: Series, number: int) -> Picture:
    """Return quantities over time; a long series as the envelope of its extremes."""
    time, values = envelope(series.time, series.values, COLUMNS)
    seconds = (time - time[0]) / SECOND if time.size else time.astype(float)
    with mpl.rc_context(_STYLE):
        canvas = Canvas(figsize=(SIZE[0], SIZE[1] * 0.75))
        axes = canvas.add_subplot()
        axes.set(xlabel="time from the first sample [s]", ylabel=f"[{series.unit}]")
        for i, name in enumerate(series.names):
            color = _color(series.colors[i][:3]) if i < len(series.colors) else None
            axes.plot(seconds, values[:, i], lw=0.7, color=color, label=name)
        return Picture(series.title, _svg(canvas, axes, number))


def track_picture(tracks: Sequence[Track], number: int) -> Picture:
    """Return trajectories in metres east and north of the first point of the first one."""
    origin = tracks[0].position[0]
    with mpl.rc_context(_STYLE):
        canvas = Canvas(figsize=TRACK_SIZE)
        axes = canvas.add_subplot()
        axes.set_aspect("equal", adjustable="datalim")
        axes.set(xlabel="east [m]", ylabel="north [m]")
        for track in tracks:
            points = local_plane(track.position[:: max(1, len(track.position) // (2 * POINTS))], origin)
            (line,) = axes.plot(points[:, 0], -points[:, 1], color=_color(track.color), lw=1.2)
            if track.label or len(tracks) == 1:
                line.set_label(track.label or track.name)
        axes.plot([0], [0], "o", ms=4, color=_INK, label="start")
        return Picture(f"Track of {tracks[0].name}: north up", _svg(canvas, axes, number))


def _draw(axes: Any, curve: Curve) -> None:  # noqa: ANN401 - matplotlib has no types
    x, y, low, high = _thinned(curve)
    color, label = _color(curve.color), curve.label or None
    few = x.size <= MARKED
    look: dict[str, Any] = {
        "line": {"marker": "o" if few else None, "ms": 3}, "curve": {}, "points": {"ls": "", "marker": "o", "ms": 3},
        "fit": {"lw": 0.9, "alpha": 0.9}, "faint": {"lw": 0.6, "alpha": 0.55},
    }[curve.style]  # fmt: skip
    axes.plot(x, y, color=color, label=label, **look)
    if low is not None and high is not None:
        if few:
            axes.vlines(x, low, high, color=color, lw=0.8, alpha=0.7)
        else:
            axes.fill_between(x, low, high, color=color, alpha=0.18, lw=0)


def _thinned(curve: Curve) -> tuple[Floats, Floats, Floats | None, Floats | None]:
    """Return at most some points of a curve: of each span the smallest and the largest."""
    x, y = np.asarray(curve.x, float), np.asarray(curve.y, float)
    low, high = (None if part is None else np.asarray(part, float) for part in (curve.lower, curve.upper))
    if x.size <= 2 * POINTS:
        return x, y, low, high
    edges = np.linspace(0, x.size, POINTS + 1).astype(int)
    known = np.where(np.isfinite(y), y, -np.inf)
    kept = np.unique([
        at for a, b in pairwise(edges) for at in (a + int(np.argmin(y[a:b])), a + int(np.argmax(known[a:b])))
    ])  # fmt: skip
    return x[kept], y[kept], None if low is None else low[kept], None if high is None else high[kept]


def _limit(axes: Any, figure: Figure) -> None:  # noqa: ANN401 - matplotlib has no types
    """Limit the axes to what the figure states, or to its solid curves; a faint one may be cut off."""
    solid = [curve for curve in figure.curves if curve.style != "faint"] or list(figure.curves)
    for limits, scale, parts, put in (
        (figure.x_limits, figure.x_scale, (curve.x for curve in solid), axes.set_xlim),
        (figure.y_limits, figure.y_scale, (part for c in solid for part in (c.y, c.lower, c.upper)), axes.set_ylim),
    ):
        ends = limits or _ends(parts, log=scale == "log")
        if ends is not None:
            put(*ends)


def _ends(parts: Iterable[Floats | None], *, log: bool) -> tuple[float, float] | None:
    arrays = [np.asarray(part, float).ravel() for part in parts if part is not None]
    values = np.concatenate(arrays) if arrays else np.empty(0)
    values = values[np.isfinite(values) & ((values > 0) | (not log))]
    if not values.size:
        return None
    low, high = float(values.min()), float(values.max())
    if log:
        return max(low, high * 1e-9) / 1.5, high * 1.5
    air = (high - low) * 0.05 or abs(high) * 0.1 or 1.0
    return low - air, high + air


def _color(color: Sequence[int] | Color) -> str:
    r, g, b = color[:3]
    if (r, g, b) in (INK, PALE):
        return _INK
    return f"#{r:02x}{g:02x}{b:02x}"


def _svg(canvas: Canvas, axes: Any, number: int) -> str:  # noqa: ANN401 - matplotlib has no types
    axes.minorticks_off()
    if axes.get_legend_handles_labels()[1]:
        canvas.legend(loc="outside right upper")
    buffer = io.StringIO()
    canvas.savefig(
        buffer, format="svg", transparent=True, metadata={"Date": None, "Creator": None, "Format": None, "Type": None}
    )
    return _small(buffer.getvalue(), number)


def _small(text: str, number: int) -> str:
    """Return the svg element alone, with short numbers, ids of its own, and the page's colours."""
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>|<style.*?</style>", "", text, flags=re.DOTALL)
    text = re.sub(r'(<svg[^>]*?) width="[^"]*"', r"\1", text, count=1)
    text = re.sub(r'(<svg[^>]*?) height="[^"]*"', r"\1", text, count=1)
    text = re.sub(r"<!--.*?-->|<defs>\s*</defs>", "", text, flags=re.DOTALL)
    used = set(re.findall(r"#([\w.-]+)", text))
    text = re.sub(r' id="([^"]*)"', lambda match: match[0] if match[1] in used else "", text)
    text = re.sub(r"\s*\nL ", " ", text)  # after one L, further points need no letter
    for sentinel, theme in _THEME.items():
        text = text.replace(sentinel, theme)
    text = re.sub(r'(id="|href="#|url\(#)', rf"\g<1>f{number}-", text)
    text = _PLACES.sub(lambda part: _NUMBER.sub(lambda match: _short(match[0]), part[0]), text)
    return re.sub(r"\s*\n\s*", "\n", text).strip()


def _short(number: str) -> str:
    value = round(float(number), 1)
    return f"{value:g}" if math.isfinite(value) else number


def pictures(items: Iterable[Figure | Series | Sequence[Track]]) -> Iterator[Picture]:
    """Yield the pictures of figures, series and groups of tracks."""
    for number, item in enumerate(items):
        if isinstance(item, Figure):
            yield figure_picture(item, number)
        elif isinstance(item, Series):
            yield series_picture(item, number)
        else:
            yield track_picture(item, number)

"""Draws figures, series and tracks with matplotlib, for a page or for a paper."""

import io
import textwrap
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import matplotlib as mpl
import numpy as np
from matplotlib.colors import to_hex
from matplotlib.figure import Figure as Canvas

from imuwb.analysis import Curve, Figure, Mark, Series
from imuwb.arrays import Floats
from imuwb.colors import Color, color_at
from imuwb.log import SECOND
from imuwb.review.drawn.calls import Track
from imuwb.review.figures.track import local_plane
from imuwb.review.page.ticks import put_ticks

HEIGHT = {"figure": 0.5, "series": 0.38, "track": 0.7}  #: of the width
TITLE = 44  #: letters of a line of an axis's title
LEGEND = 40  #: letters of a line of the legend
BACKGROUND_STYLES = ("fit", "faint")  #: that curves of several colours share
FAINT = 0.25  #: share of the length of an axis by which a faint curve may make it longer at each end
HIDDEN = "\N{ZERO WIDTH SPACE}"  #: before a label that matplotlib would leave out
BAR = 5.0  #: width of a bar
BAND = 8.0  #: width of a band in a legend
MARKED = 40  #: points, up to which each has a marker
Drawing: TypeAlias = Figure | Series | Sequence[Track]
#: form -> what keeps the date out of its file, so that equal results make equal files
NO_DATE: dict[str, dict[str, None]] = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
TIMES = ((2 * 86400, "d", 86400), (2 * 3600, "h", 3600), (300, "min", 60), (0, "s", 1))  #: from that span, s: its unit


@dataclass(frozen=True, slots=True)
class Look:
    """How a canvas looks."""

    width: float  #: inches
    font: float  #: points
    ink: str  #: colour of texts
    grid: str
    color: Callable[[Color], str]  #: the colour of a curve, from that of imuwb
    background: str | None = None  #: None: transparent
    dots: float = 72.0  #: per inch, of a PNG


@dataclass(frozen=True, slots=True)
class Entry:
    """A line of a legend that is not part of its drawing."""

    label: str
    color: str
    line: float  #: width; 0: none
    dot: float  #: size of a point; 0: none
    opacity: float = 1.0
    dashed: bool = False
    mark: bool = False  #: whether the point is a diamond


def render(item: Drawing, look: Look, form: str) -> bytes:
    """Return a figure, a series, or tracks that share a picture, as a file of a form (svg, png or pdf), with its legend."""
    return _rendered(item, look, form, legend=True)[0]


def render_apart(item: Drawing, look: Look) -> tuple[bytes, tuple[Entry, ...]]:
    """Return a drawing as SVG without its legend, and the legend."""
    return _rendered(item, look, "svg", legend=False)


def _rendered(item: Drawing, look: Look, form: str, *, legend: bool) -> tuple[bytes, tuple[Entry, ...]]:
    with mpl.rc_context(_style(look)):
        kind = "figure" if isinstance(item, Figure) else "series" if isinstance(item, Series) else "track"
        canvas, axes = _canvas(look, HEIGHT[kind])
        if isinstance(item, Figure):
            _figure(item, look, axes)
        elif isinstance(item, Series):
            _series(item, look, axes)
        else:
            _tracks(item, look, axes)
        scales = (item.x_scale, item.y_scale) if isinstance(item, Figure) else ("linear", "linear")
        put_ticks(axes, scales)
        for line in (*axes.get_xgridlines(), *axes.get_ygridlines()):
            line.set_clip_on(False)
        handles, labels = axes.get_legend_handles_labels()
        if legend and labels:
            canvas.legend(loc="outside right upper")
        file = io.BytesIO()
        canvas.savefig(file, format=form, metadata=NO_DATE.get(form), dpi=look.dots)
        return file.getvalue(), tuple(_entry(handle, label) for handle, label in zip(handles, labels, strict=True))


def _entry(handle: Any, label: str) -> Entry:  # noqa: ANN401 - matplotlib has no types
    text = label.removeprefix(HIDDEN).replace(r"\$", "$").replace("\n", " ")
    opacity = handle.get_alpha() or 1.0
    if not hasattr(handle, "get_markersize"):  # a band
        return Entry(text, to_hex(np.atleast_2d(handle.get_facecolor())[0]), BAND, 0.0, opacity)
    marker, style = handle.get_marker(), handle.get_linestyle()
    dot = handle.get_markersize() if marker not in (None, "None", "") else 0.0
    line = 0.0 if style in ("None", "") or marker == "D" else handle.get_linewidth()
    return Entry(text, to_hex(handle.get_color()), line, dot, opacity, style == "--", marker == "D")


def _figure(figure: Figure, look: Look, axes: Any) -> None:  # noqa: ANN401 - matplotlib has no types
    """Draw a figure of an analysis. Each axis is as long as the solid curves need."""
    axes.set(
        xlabel=_plain(figure.x_title),
        ylabel=_plain("\n".join(textwrap.wrap(figure.y_title, TITLE))),
        xscale="log" if figure.x_scale == "log" else "linear",
        yscale="log" if figure.y_scale == "log" else "linear",
    )
    _limit(axes, figure)
    for curve in figure.curves:
        _draw(axes, curve, look, _legend_color(figure, curve, look))
    for vertical in figure.verticals:
        axes.axvline(vertical.x, color=look.color(vertical.color), ls="--", lw=0.8, label=_label(vertical.text))
    for mark in figure.marks:
        label = _label(mark_text(figure, mark))
        axes.plot([mark.x], [mark.y], "D", ms=4, mec=look.ink, mew=0.5, color=look.color(mark.color), label=label)


def mark_text(figure: Figure, mark: Mark) -> str:
    """Return a mark's name with its value; without one, its place with the units of the axes: "N x: 145 deg/h at 1 s"."""
    x, y = (
        f"{value:.3g} {unit}".rstrip()
        for value, unit in ((mark.x, _unit(figure.x_title)), (mark.y, _unit(figure.y_title)))
    )
    return f"{mark.text}: {mark.value}" if mark.value else f"{mark.text}: {y} at {x}"


def _unit(title: str) -> str:
    """Return the unit that the title of an axis contains; empty: none, or 1."""
    unit = title.rpartition("[")[2].partition("]")[0] if "[" in title else ""
    return "" if unit == "1" else unit


def _legend_color(figure: Figure, curve: Curve, look: Look) -> str:
    """Return the colour of a curve in the legend: that of texts for a style that curves of several colours share."""
    colors = {other.color for other in figure.curves if other.style == curve.style}
    return look.ink if curve.style in BACKGROUND_STYLES and len(colors) > 1 else look.color(curve.color)


def _series(series: Series, look: Look, axes: Any) -> None:  # noqa: ANN401 - matplotlib has no types
    """Draw quantities over time."""
    time = series.time - series.time[0] if series.time.size else series.time
    span = float(time[-1]) / SECOND if time.size else 0.0
    unit, length = next((unit, length) for least, unit, length in TIMES if span >= least)
    axes.set(xlabel=f"time from the first sample [{unit}]", ylabel=_plain(f"[{series.unit}]"))
    _shade(series, look, axes, length)
    for i, name in enumerate(series.names):
        r, g, b = series.colors[i][:3] if i < len(series.colors) else color_at(i)
        color = look.color((r, g, b))
        label = None if name in series.names[:i] else _label(name)
        axes.plot(time / (length * SECOND), series.values[:, i], lw=0.7, color=color, label=label)


def _shade(series: Series, look: Look, axes: Any, length: int) -> None:  # noqa: ANN401 - matplotlib has no types
    """Shade the spans of a series; ``length`` is the unit of the time axis, s."""
    named: set[str] = set()
    for span in series.spans if series.time.size else ():
        ends = [(t - int(series.time[0])) / (length * SECOND) for t in (span.begin, span.end)]
        label = None if span.text in named else _label(span.text)
        axes.fill_between(
            ends,
            0,
            1,
            transform=axes.get_xaxis_transform(),
            color=look.color(span.color),
            alpha=0.18,
            lw=0,
            label=label,
        )
        named.add(span.text)


def _tracks(tracks: Sequence[Track], look: Look, axes: Any) -> None:  # noqa: ANN401 - matplotlib has no types
    """Draw trajectories, in metres east and north of the first point of the first one."""
    origin = tracks[0].position[0]
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xlabel="east [m]", ylabel="north [m]")
    named: set[str] = set()
    for track in tracks:
        points = local_plane(track.position, origin)
        (line,) = axes.plot(points[:, 0], -points[:, 1], color=look.color(track.color), lw=1.2)
        name = track.label or track.name
        if name not in named:
            line.set_label(_label(name))
        named.add(name)
    axes.plot([0], [0], "o", ms=5, color=look.ink, label="start")


def _canvas(look: Look, height: float) -> tuple[Canvas, Any]:
    """Return an empty canvas and its axes."""
    canvas = Canvas(figsize=(look.width, look.width * height), facecolor=look.background or "none")
    return canvas, canvas.add_subplot(facecolor="none")


def _style(look: Look) -> Any:  # noqa: ANN401 - matplotlib names its settings in a type of its own
    size = look.font
    return {
        "font.size": size, "font.family": "sans-serif", "text.color": look.ink, "axes.labelcolor": look.ink,
        "axes.edgecolor": look.ink, "xtick.color": look.ink, "ytick.color": look.ink, "axes.grid": True, "grid.color": look.grid,
        "legend.frameon": False, "legend.fontsize": size - 1, "axes.spines.top": False, "axes.spines.right": False,
        "axes.linewidth": 0.7, "grid.linewidth": 0.7, "figure.constrained_layout.use": True, "xtick.major.size": 0,
        "ytick.major.size": 0, "lines.linewidth": 1.2, "axes.unicode_minus": True, "axes.formatter.limits": (-4, 5),
        "svg.fonttype": "none", "svg.hashsalt": "imuwb", "pdf.fonttype": 42,
    }  # fmt: skip


def _plain(text: str) -> str:
    """Return a text that matplotlib does not read as a formula."""
    return text.replace("$", r"\$")


def _label(text: str) -> str | None:
    """Return a text for the legend; None for no text, and a text that matplotlib neither hides nor reads as a formula."""
    shown = _plain("\n".join(textwrap.wrap(text, LEGEND)))
    return f"{HIDDEN}{shown}" if shown.startswith("_") else shown or None


def _draw(axes: Any, curve: Curve, look: Look, legend: str) -> None:  # noqa: ANN401 - matplotlib has no types
    color, label = look.color(curve.color), _label(curve.label)
    if curve.style == "band" and curve.lower is not None and curve.upper is not None:
        axes.fill_between(curve.x, curve.lower, curve.upper, color=color, alpha=0.18, lw=0, label=label)
        return
    if curve.style == "bar":
        known = np.isfinite(curve.y)
        axes.vlines(curve.x[known], 0.0, curve.y[known], color=color, lw=BAR)
        if label:
            axes.plot([], [], color=legend, label=label, lw=BAR)
        return
    few = curve.x.size <= MARKED
    shape: dict[str, Any] = {
        "line": {"marker": "o" if few else None, "ms": 3}, "curve": {}, "points": {"ls": "", "marker": "o", "ms": 4},
        "fit": {"lw": 0.9, "alpha": 0.9}, "faint": {"lw": 0.6, "alpha": 0.55}, "band": {},
    }[curve.style]  # fmt: skip
    axes.plot(curve.x, curve.y, color=color, **shape)
    if label:
        axes.plot([], [], color=legend, label=label, **shape)
    if curve.lower is None or curve.upper is None:
        return
    if few:
        gap = np.full_like(curve.x, np.nan)
        bars_x, bars_y = (
            np.stack(parts, axis=1).ravel() for parts in ((curve.x, curve.x, gap), (curve.lower, curve.upper, gap))
        )
        axes.plot(bars_x, bars_y, color=color, lw=0.8, alpha=0.7)
    else:
        axes.fill_between(curve.x, curve.lower, curve.upper, color=color, alpha=0.18, lw=0)


def _limit(axes: Any, figure: Figure) -> None:  # noqa: ANN401 - matplotlib has no types
    """Limit the axes to what the figure states, or to its curves and marks; of faint curves, ends may be cut off."""
    faint, solid = ([c for c in figure.curves if (c.style == "faint") == which] for which in (True, False))
    for limits, scale, mark, parts, put in (
        (figure.x_limits, figure.x_scale, "x", ("x",), axes.set_xlim),
        (figure.y_limits, figure.y_scale, "y", ("y", "lower", "upper"), axes.set_ylim),
    ):
        values, extra = (
            _shown([getattr(c, part) for c in curves for part in parts], log=scale == "log")
            for curves in (solid, faint)
        )
        marks = _shown([np.array([getattr(one, mark) for one in figure.marks])], log=scale == "log")
        put(*(limits or _ends(np.concatenate([values, marks]), extra, log=scale == "log")))


def _shown(parts: Iterable[Floats | None], *, log: bool) -> Floats:
    """Return all values that an axis can show; logarithms for a logarithmic one."""
    arrays = [np.asarray(part, float).ravel() for part in parts if part is not None]
    values = np.concatenate(arrays) if arrays else np.empty(0)
    values = values[np.isfinite(values) & ((values > 0) | (not log))]
    return np.log10(values) if log else values


def _ends(values: Floats, extra: Floats, *, log: bool) -> tuple[float, float]:
    """Return the ends of an axis that contain all values, with air, and as much of extra ones as is worth its place."""
    values, extra = (values, extra) if values.size else (extra, values)
    if not values.size:
        return (1.0, 10.0) if log else (0.0, 1.0)
    low, high = float(values.min()), float(values.max())
    room = FAINT * (high - low)
    if extra.size:
        low, high = max(min(low, float(extra.min())), low - room), min(max(high, float(extra.max())), high + room)
    air = (high - low) * 0.04 or (0.2 if log else abs(high) * 0.1 or 1.0)
    return (10 ** (low - air), 10 ** (high + air)) if log else (low - air, high + air)

"""The figures of an outage replay."""

from collections.abc import Iterable

import numpy as np

from imuwb.analysis import Curve, Figure
from imuwb.colors import (
    BLUE,
    BROWN,
    GREEN,
    GREY,
    INK,
    ORANGE,
    PALE,
    PINK,
    PURPLE,
    RED,
    TEAL,
    YELLOW,
    Color,
    between,
)
from imuwb.replay.scoring.budget import COMMON
from imuwb.texts import counted
from imuwb_plugins.outage.result import DurationSummary, ErrorBudget, Result

COLORS: dict[str, Color] = {
    "none": GREY, "15AV": BLUE, "18AV": GREEN, "18AVWD": BROWN, "15AR": ORANGE, "27AR": PURPLE, "full": TEAL, "motion": RED, "tuned": YELLOW,
}  # fmt: skip
SOURCES: tuple[Color, ...] = (RED, BLUE, GREEN, ORANGE, PURPLE, TEAL, YELLOW)
OTHERS: tuple[Color, ...] = (PINK, PALE, between(ORANGE, INK, 0.5))
AIR = 1.2  #: factor between the largest error and the end of its axis
TIME, ERROR = "time without GNSS [s]", "horizontal error [m]"


def color_of(name: str) -> Color:
    """Return the colour of a filter."""
    return COLORS.get(name, OTHERS[0])


def colors_of(names: Iterable[str]) -> dict[str, Color]:
    """Return the colours of filters and of other engines, which get colours that no filter has, in turns."""
    names = list(names)
    others = [name for name in names if name not in COLORS]
    return {name: COLORS[name] if name in COLORS else OTHERS[others.index(name) % len(OTHERS)] for name in names}


def drift(own: DurationSummary) -> Figure:
    """Return the drift of each filter: median and 95 % quantile."""
    curves, colors = list[Curve](), colors_of(own.models)
    for name in own.ranked:
        s = own.models[name]
        curves.append(Curve(name, s.curve.elapsed, s.curve.median, colors[name], style="curve"))
        curves.append(Curve("", s.curve.elapsed, s.curve.p95, colors[name], style="faint"))
    title = f"Drift in outages of {own.duration:g} s: median, and 95 % quantile (faint)"
    shown = np.concatenate([curve.y for curve in curves])
    shown = shown[np.isfinite(shown) & (shown > 0)]
    # Faint curves do not set the limits of a figure, but the panel states where the 95 % quantile ends.
    limits = (float(shown.min()) / AIR, float(shown.max()) * AIR) if shown.size else None
    return Figure(title, TIME, ERROR, tuple(curves), x_scale="linear", y_limits=limits)


def consistency(own: DurationSummary) -> Figure:
    """Return the NEES of each filter that states a sigma over time, and the band in which it lies if sigma is right."""
    ranked, colors = [(name, own.models[name]) for name in own.ranked], colors_of(own.models)
    curves = [
        Curve(name, s.curve.elapsed, s.curve.nees_per_dof, colors[name], style="curve")
        for name, s in ranked
        if np.isfinite(s.curve.nees_per_dof).any()
    ]
    tested = next((s.consistency for _, s in ranked if s.consistency), ())
    if tested and curves:
        x, low, high = (np.array([getattr(c, part) for c in tested]) for part in ("elapsed", "lower", "upper"))
        begin = min(float(curves[0].x[0]), float(x[0]))
        x, low, high = (np.insert(values, 0, first) for values, first in ((x, begin), (low, low[0]), (high, high[0])))
        curves.append(Curve("sigma is right", x, (low + high) / 2, INK, low, high, style="band"))
    title = f"NEES over its two degrees of freedom in outages of {own.duration:g} s"
    return Figure(title, TIME, "mean NEES/2 [1]; above the band: sigma is too small", tuple(curves), x_scale="linear")


def errors(result: Result, name: str) -> Figure:
    """Return the errors of some outages, with one and three sigma of the filter."""
    samples = result.samples
    lines, elapsed = samples.errors[name], samples.elapsed
    sigma = result.summary[-1].models[name].curve.sigma
    x = np.tile(np.append(elapsed, np.nan), len(lines))
    y = np.concatenate([np.append(line, np.nan) for line in lines])
    return Figure(
        f"{name}: errors in {counted(len(lines), 'outage')}, and its sigma", TIME, ERROR,
        (
            Curve("errors", x, y, color_of(name), style="faint"),
            Curve("1 sigma", elapsed, sigma, INK, style="curve"),
            Curve("3 sigma", elapsed, 3 * sigma, GREY, style="curve"),
        ),
        x_scale="linear", y_scale="linear", y_limits=(0.0, 1.15 * samples.limit[name]), group="errors",
    )  # fmt: skip


def budget(b: ErrorBudget) -> Figure:
    """Return the sources of a filter's sigma over time."""
    curves = [Curve("all", b.elapsed, b.total, INK, style="curve")]
    shown = [(source, sigma) for source, sigma in zip(b.sources, b.sigma, strict=True) if source != COMMON]
    for color, (source, sigma) in zip(SOURCES, shown, strict=False):
        curves.append(Curve(source, b.elapsed, sigma, color, style="curve"))
    return Figure(
        f"Sources of the sigma of {b.filter}", TIME, "horizontal sigma [m]", tuple(curves),
        y_limits=(1e-2, 1.3 * float(b.total[-1])),
    )  # fmt: skip

"""Figures and tables of the Allan analysis."""

from imuwb.analysis import Curve, Figure, Mark, Review
from imuwb.colors import AXIS_COLORS, Color
from imuwb.identification import Stationarity
from imuwb.units import UNITS, Unit
from imuwb_plugins.allan import tables
from imuwb_plugins.allan.result import AllanAxis, Result

_SENSORS = {"gyro": ("Gyroscopes", UNITS["deg/h"]), "accel": ("Accelerometers", UNITS["m/s²"])}
DARKEST = 0.25  #: share of the axis's colour in the curve of the first part


def draw(result: Result, review: Review) -> None:
    """Show notes, figures and tables."""
    for note in result.notes:
        review.note(note)
    for sensor, (name, unit) in _SENSORS.items():
        axes = {axis: r for axis, r in result.axes.items() if axis.startswith(sensor) and r.averaging_time.size}
        if axes:
            review.figure(_figure(name, unit, axes, result.level))
    for table in tables.fits(result):
        review.table(table)
    if any(r.estimates for r in result.axes.values()):
        for table in tables.comparisons(result):
            review.table(table)
        _parts(result, review)
    _other(result, review)


def _figure(name: str, unit: Unit, axes: dict[str, AllanAxis], level: float) -> Figure:
    curves: list[Curve] = []
    for axis, r in axes.items():
        curves += _curves(axis, r, unit, labelled=not any(curve.style == "faint" for curve in curves))
    marks = tuple(
        Mark(m.averaging_time, unit.from_si(m.deviation), f"{m.letter} {axis[-1]}", AXIS_COLORS[axis[-1]])
        for axis, r in axes.items()
        for m in r.read_outs
    )
    title = f"Allan deviation [{unit.name}], {100 * level:g} % intervals"
    return Figure(f"{name}: Allan deviation", "averaging time [s]", title, tuple(curves), marks)


def _curves(axis: str, r: AllanAxis, unit: Unit, *, labelled: bool) -> list[Curve]:
    """Return the curves of an axis; the first fitted sum and its terms are labelled in the legend."""
    color, scale = AXIS_COLORS[axis[-1]], 1 / unit.factor
    arrays = (r.allan_deviation * scale, color, r.lower * scale, r.upper * scale)
    curves = [Curve(axis.replace("_", " "), r.averaging_time, *arrays)]
    model = r.model_curves
    if model is None:
        return curves
    curves.append(
        Curve("fitted sum" if labelled else "", model.averaging_time, model.total * scale, color, style="fit")
    )
    for i, term in enumerate(model.terms):
        label = "its terms" if labelled and i == 0 else ""
        curves.append(Curve(label, model.averaging_time, term * scale, color, style="faint"))
    return curves


def _parts(result: Result, review: Review) -> None:
    """Show the Allan deviations of the parts of the first axis that is not stationary; a table names the others."""
    for axis, r in result.axes.items():
        stationarity = r.estimates.stationarity if r.estimates else None
        if stationarity is not None and not stationarity.stationary:
            review.figure(_dynamic(axis, stationarity, _SENSORS[axis.partition("_")[0]][1]))
            return


def _dynamic(axis: str, stationarity: Stationarity, unit: Unit) -> Figure:
    parts = stationarity.start.size
    labelled = (0, stationarity.worst_part, parts - 1)
    curves = tuple(
        Curve(
            f"from {start:.0f} s" if i in labelled else "", stationarity.averaging_time, deviation / unit.factor,
            _shade(AXIS_COLORS[axis[-1]], i / (parts - 1)), style="curve",
        )
        for i, (start, deviation) in enumerate(zip(stationarity.start, stationarity.deviation, strict=True))
    )  # fmt: skip
    title = f"{axis.replace('_', ' ')}: Allan deviation of {parts} parts, dark to light in time"
    return Figure(title, "averaging time [s]", f"Allan deviation [{unit.name}]", curves)


def _shade(color: Color, place: float) -> Color:
    r, g, b = (int(c * (DARKEST + (1 - DARKEST) * place)) for c in color)
    return r, g, b


def _other(result: Result, review: Review) -> None:
    for sensor, (name, unit) in _SENSORS.items():
        others = {axis: r.other for axis, r in result.axes.items() if axis.startswith(sensor) and r.other is not None}
        if not others:
            continue
        kind, scale = next(iter(others.values())).kind, 1 / unit.factor
        curves = tuple(
            Curve(
                axis.replace("_", " "), o.averaging_time, o.deviation * scale, AXIS_COLORS[axis[-1]], o.lower * scale, o.upper * scale
            )
            for axis, o in others.items()
        )  # fmt: skip
        title = f"{kind} deviation [{unit.name}], {100 * result.level:g} % intervals"
        review.figure(Figure(f"{name}: {kind} deviation", "averaging time [s]", title, curves))

"""Figures and tables of the Allan analysis."""

import numpy as np

from imuwb.analysis import Curve, Figure, Mark, Review
from imuwb.arrays import Floats
from imuwb.colors import AXIS_COLORS, Color
from imuwb.identification import Stationarity
from imuwb.noise_results import SENSORS, by_sensor, with_models
from imuwb.units import UNITS, Unit, coefficient_units
from imuwb_plugins.allan import tables
from imuwb_plugins.allan.result import AllanAxis, Result

_UNITS = {"gyro": UNITS["deg/h"], "accel": UNITS["m/s²"]}
DARKEST = 0.45  #: share of the axis's colour in the curve of the first part


def draw(result: Result, review: Review) -> None:
    """Show notes, figures and tables."""
    for note in result.notes:
        review.note(note)
    for sensor, axes in by_sensor({axis: r for axis, r in result.axes.items() if r.averaging_time.size}).items():
        review.figure(_figure(sensor, axes, result.level))
    for table in tables.fits(result):
        review.table(table)
    if any(r.estimates for r in result.axes.values()):
        for table in tables.comparisons(result):
            review.table(table)
        _parts(result, review)
    _other(result, review)


def _figure(sensor: str, axes: dict[str, AllanAxis], level: float) -> Figure:
    unit = _UNITS[sensor]
    curves = with_models(
        (
            (_curve(axis, r.averaging_time, (r.allan_deviation, r.lower, r.upper), unit), r.model_curves)
            for axis, r in axes.items()
        ),
        unit.factor,
    )
    marks = tuple(
        Mark(
            m.averaging_time,
            unit.from_si(m.deviation),
            f"{m.letter} {axis[-1]} (Allan)",
            AXIS_COLORS[axis[-1]],
            _value(axis, r, m.letter),
        )
        for axis, r in axes.items()
        for m in r.read_outs
    )
    title = f"Allan deviation [{unit.name}], {100 * level:g} % intervals"
    return Figure(f"{SENSORS[sensor]}: Allan deviation", "averaging time [s]", title, curves, marks)


def _value(axis: str, r: AllanAxis, letter: str) -> str:
    """Return a coefficient as a text for the legend, without its interval, which the table has."""
    value, unit = r.coefficients[letter].value, coefficient_units(axis, letter)[1]
    return "" if value is None else f"{unit.from_si(value):.3g} {unit.name}"


def _curve(axis: str, time: Floats, ends: tuple[Floats, Floats, Floats], unit: Unit) -> Curve:
    """Return the deviation of an axis with its interval; ``ends`` are the deviation, its lower and its upper end."""
    deviation, lower, upper = (values / unit.factor for values in ends)
    return Curve(axis.replace("_", " "), time, deviation, AXIS_COLORS[axis[-1]], lower, upper)


def _parts(result: Result, review: Review) -> None:
    """Show the Allan deviations of the parts of the axis that changes most; a table names the others."""
    tested = {axis: r.estimates.stationarity for axis, r in result.axes.items() if r.estimates}
    changing = {axis: s for axis, s in tested.items() if s is not None and not s.stationary}
    if changing:
        axis = max(changing, key=lambda axis: float(abs(np.log(changing[axis].worst_ratio))))
        review.figure(_dynamic(axis, changing[axis], _UNITS[axis.partition("_")[0]]))


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
    others = {axis: r.other for axis, r in result.axes.items() if r.other is not None}
    for sensor, axes in by_sensor(others).items():
        unit, kind = _UNITS[sensor], next(iter(axes.values())).kind
        curves = tuple(
            _curve(axis, o.averaging_time, (o.deviation, o.lower, o.upper), unit) for axis, o in axes.items()
        )
        title = f"{kind} deviation [{unit.name}], {100 * result.level:g} % intervals"
        review.figure(Figure(f"{SENSORS[sensor]}: {kind} deviation", "averaging time [s]", title, curves))

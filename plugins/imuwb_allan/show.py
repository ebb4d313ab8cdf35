"""Figures and tables of the Allan analysis. Nothing is computed here but units."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from imuwb.analysis import AXIS_COLORS, Curve, Figure, Mark, Table
from imuwb.stochastic import Sinusoid, Sum
from imuwb.units import UNITS, coefficient_units

if TYPE_CHECKING:
    from imuwb.analysis import Review
    from imuwb.units import Unit
    from imuwb_allan.result import AxisResult, CoefficientResult, Result

_FIGURES = {"gyro": ("Gyroscopes", "deg/h"), "accel": ("Accelerometers", "m/s²")}
_SLOPES = {"Q": "-1", "N": "-1/2", "B": "0", "K": "+1/2", "R": "+1"}


def draw(result: Result, review: Review) -> None:
    """Show the result, what a reader must know first."""
    for note in result.notes:
        review.note(note)
    _fit_notes(result, review)
    for sensor, (name, unit) in _FIGURES.items():
        axes = {axis: found for axis, found in result.axes.items() if axis.startswith(sensor)}
        if any(found.averaging_time.size for found in axes.values()):
            review.figure(_figure(name, UNITS[unit], axes, 1 / result.rate_hz[sensor], result.level))
    review.table(_coefficients(result))
    review.table(_slopes(result))
    if any(found.lines for found in result.axes.values()):
        review.table(_lines(result))


def _figure(name: str, unit: Unit, axes: dict[str, AxisResult], dt: float, level: float) -> Figure:
    curves: list[Curve] = []
    marks: list[Mark] = []
    named = False
    for axis, found in axes.items():
        color = AXIS_COLORS[axis[-1]]
        tau, scale = found.averaging_time, 1 / unit.factor
        curves.append(
            Curve(
                axis.replace("_", " "),
                tau,
                found.allan_deviation * scale,
                color,
                found.lower * scale,
                found.upper * scale,
            )
        )
        if found.fitted is None or found.processes is None:
            continue
        begin = found.fit.from_averaging_time if found.fit else tau[0]
        smooth = np.geomspace(begin, max(tau[-1], 1.01 * begin), 200)
        whole = np.sqrt(found.processes.allan_variance(smooth, dt))
        curves.append(Curve("" if named else "fitted sum", smooth, whole * scale, color, style="fit"))
        lines = Sum(tuple(term for term in found.processes.terms if isinstance(term, Sinusoid)))
        others = [term for term in found.processes.terms if not isinstance(term, Sinusoid)]
        for part in (*others, *([lines] if lines.terms else [])):
            alone = np.sqrt(part.allan_variance(smooth, dt))
            curves.append(Curve("" if named else "its terms", smooth, alone * scale, color, style="faint"))
            named = True
        for letter, place in (("N", 1.0), ("K", 3.0), ("B", None)):
            c = found.coefficients[letter]
            at = place if place is not None else c.at
            if c.value is not None and at is not None and tau[0] <= at <= tau[-1]:
                height = {"N": c.value, "K": c.value, "B": 0.6643 * c.value}[letter]
                marks.append(Mark(at, height * scale, f"{letter} {axis[-1]}", color))
    return Figure(
        f"{name}: Allan deviation",
        "averaging time [s]",
        f"Allan deviation [{unit.name}], {100 * level:g} % intervals",
        tuple(curves),
        tuple(marks),
    )


def _coefficients(result: Result) -> Table:
    rows = tuple(
        (axis, *(_cell(axis, letter, found.coefficients[letter]) for letter in "QNBKR"), _correlation(found))
        for axis, found in result.axes.items()
    )
    headings = (
        "axis", "Q quantization", "N random walk", "B bias instability", "K rate random walk", "R rate ramp", "Tc of B",
    )  # fmt: skip
    caption = (
        f"Value [{100 * result.level:g} % interval]; < is a {100 * result.level:g} % upper limit of a term that is not identified. Q is read at √3 s, N at 1 s, K at 3 s, "
        "R at √2 s on the term's own line; B is the flat level / 0.664. Tc: centre [begin, end] of the flat region where it ends within the record; "
        "matched to a Gauss-Markov peak it is / 1.89."
    )
    moving = " (NOT a static record: see the notes)" if result.moving else ""
    return Table(f"Noise coefficients of {result.imu}{moving}", headings, rows, caption)


def _cell(axis: str, letter: str, c: CoefficientResult) -> str:
    unit = coefficient_units(axis, letter)[1]
    if c.value is None:
        return "—" if c.upper is None else f"< {unit.from_si(c.upper):.3g} {unit.name}"
    low, high = (unit.from_si(end) for end in (c.lower or 0.0, c.upper or 0.0))
    value = unit.from_si(c.value)
    # As many digits as the interval is worth: two of its width.
    digits = int(np.clip(2 - np.floor(np.log10((high - low) / value)), 3, 6)) if high > low else 3
    return f"{value:.{digits}g} [{low:.{digits}g}, {high:.{digits}g}] {unit.name}"


def _correlation(found: AxisResult) -> str:
    tc = found.correlation_time
    return "—" if tc is None else f"{_seconds(tc.flat_centre)} [{_seconds(tc.lower)}, {_seconds(tc.upper)}] s"


def _seconds(value: float) -> str:
    """Return seconds with three digits, and without a power of ten."""
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}"  # noqa: PLR2004 - three digits


def _slopes(result: Result) -> Table:
    rows = tuple(
        (
            axis, region.letter, f"{_seconds(region.start)} to {_seconds(region.end)} s",
            f"{region.slope:+.3f} [{region.lower:+.3f}, {region.upper:+.3f}]", _SLOPES[region.letter],
            f"{region.slope - region.nominal:+.3f}" + ("" if region.lower <= region.nominal <= region.upper else " (differs)"),
        )
        for axis, found in result.axes.items()
        for region in found.regions
    )  # fmt: skip
    headings = ("axis", "term", "rules from", "free slope", "nominal", "deviation")
    caption = "The slope that a line of its own has where one term makes more than 60 % of the Allan variance; lines are taken off."
    return Table("Slopes by region", headings, rows, caption)


def _lines(result: Result) -> Table:
    rows = tuple(
        (axis, f"{line.frequency:.4g} Hz", _amplitude(axis, line.amplitude, line.lower, line.upper))
        for axis, found in result.axes.items()
        for line in found.lines
    )
    return Table(
        "Periodic lines",
        ("axis", "frequency", "amplitude"),
        rows,
        "Sinusoids in the spectrum; the fit has them as terms.",
    )


def _amplitude(axis: str, value: float, lower: float, upper: float) -> str:
    unit = coefficient_units(axis, "rate")[1]
    value, lower, upper = (unit.from_si(x) for x in (value, lower, upper))
    return f"{value:.3g} [{lower:.3g}, {upper:.3g}] {unit.name}"


def _fit_notes(result: Result, review: Review) -> None:
    cut: dict[float, list[str]] = {}
    for axis, found in result.axes.items():
        fit = found.fit
        if fit is None:
            continue
        if fit.from_averaging_time > 1.5 / result.rate_hz[axis.partition("_")[0]]:
            cut.setdefault(fit.from_averaging_time, []).append(axis)
        if fit.probability < 1e-3:  # noqa: PLR2004 - one in a thousand
            review.note(
                f"{axis}: the sum does not explain the curve (chi-square per degree of freedom {fit.misfit:.2g}); the "
                f"intervals are widened by {fit.misfit**0.5:.2g}"
            )
    for shortest, axes in cut.items():
        review.note(
            f"{', '.join(axes)}: averaging times below {shortest:.3g} s follow no sum of these processes (the sensor's "
            f"own filter, or lines), so the fit begins there"
        )

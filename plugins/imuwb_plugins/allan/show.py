"""Figures and tables of the Allan analysis. Nothing is computed here but units."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from imuwb.analysis import Curve, Figure, Mark, Table
from imuwb.colors import AXIS_COLORS
from imuwb.stochastic import GaussMarkov, Sinusoid, Sum
from imuwb.texts import coefficient_text
from imuwb.units import UNITS, coefficient_units

if TYPE_CHECKING:
    from imuwb.analysis import Review
    from imuwb.units import Unit
    from imuwb_plugins.allan.result import AxisResult, Result

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
    if any(found.estimates for found in result.axes.values()):
        review.table(_estimators(result))
        review.table(_choices(result))
        _parts(result, review)
    if any(found.other for found in result.axes.values()):
        review.figure(_other(result))


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
        (
            axis,
            *(coefficient_text(found.coefficients[letter], coefficient_units(axis, letter)[1]) for letter in "QNBKR"),
            _correlation(found),
        )
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


_NAMES = {"allan": "Allan variances", "likelihood": "likelihood of the spectrum", "wavelet": "wavelet variances (D4)"}


def _estimators(result: Result) -> Table:
    rows: list[tuple[str, ...]] = []
    for axis, found in result.axes.items():
        if found.estimates is None:
            continue
        for name, coefficients in found.estimates.by.items():
            cells = (
                coefficient_text(coefficients[x], coefficient_units(axis, x)[1]) if x in coefficients else "—"
                for x in "QNBKR"
            )
            headline = " (headline)" if name == found.estimates.headline else ""
            rows.append((axis, _NAMES[name] + headline, *cells))
        rows.append(
            (
                axis,
                "they agree" if found.estimates.agree else f"they DIFFER in {'; '.join(found.estimates.disagreements)}",
                *[""] * 5,
            )
        )
    caption = (
        "One sum, three estimators. The headline has the least error; its value is the likeliest size, and an interval that begins at 0 says "
        "that the term may be absent. The Allan fit gives a value only to what chance does not explain."
    )
    return Table("Estimators side by side", ("axis", "estimator", "Q", "N", "B", "K", "R"), tuple(rows), caption)


def _choices(result: Result) -> Table:
    rows: list[tuple[str, ...]] = []
    for axis, found in result.axes.items():
        e = found.estimates
        if e is None:
            continue
        steady = e.stationarity
        if steady is None:
            rows.append((axis, "stationary?", "too short to tell", "", ""))
        else:
            word = "yes" if steady.stationary else "NO"
            where = (
                f"part {steady.worst_part + 1} of {steady.start.size}, from {steady.start[steady.worst_part]:.0f} s, has {steady.worst_ratio:.3g} times "
                f"the usual deviation at {_seconds(steady.worst_time)} s"
            )
            rows.append((axis, "stationary?", word, f"p = {steady.smallest:.2g}", "" if steady.stationary else where))
        for i, c in enumerate(e.choice.candidates[:CANDIDATES] if e.choice else ()):
            best = e.choice.best if e.choice else c
            out = (
                ""
                if c.out_of_sample is None or best.out_of_sample is None
                else f"{c.out_of_sample - best.out_of_sample:+.1f}"
            )
            mark = " (clearly best)" if i == 0 and e.choice and e.choice.clear else ""
            mark += _times(axis, c.processes) if i == 0 else ""
            rows.append(
                (
                    axis,
                    c.name + mark,
                    f"BIC {c.bic - best.bic:+.1f}",
                    f"AIC {c.aic - best.aic:+.1f}",
                    f"out of sample {out}" if out else "",
                )
            )
    caption = (
        "Stationary: whether the parts' Allan deviations differ by more than chance (1 %, all averaging times together). Sums: differences to the best; "
        "out of sample is the deviance of each half under the other half's fit. 10 is called clear."
    )
    return Table(
        "Stationarity, and which sum explains the record", ("axis", "question or sum", "", "", ""), tuple(rows), caption
    )


CANDIDATES = 4  #: sums that are listed


def _times(axis: str, processes: Sum) -> str:
    """Return sigma and Tc of a sum's Gauss-Markov terms: the correlation time that a record tells by its likelihood."""
    unit = coefficient_units(axis, "rate")[1]
    found = [
        f"sigma {unit.from_si(t.sigma):.3g} {unit.name}, Tc {_seconds(t.Tc)} s"
        for t in processes.terms
        if isinstance(t, GaussMarkov)
    ]
    return f": {'; '.join(found)}" if found else ""


def _parts(result: Result, review: Review) -> None:
    """Show the parts' deviations of the axes that do not stay the same (dynamic Allan deviation)."""
    for axis, found in result.axes.items():
        steady = found.estimates.stationarity if found.estimates else None
        if steady is None or steady.stationary:
            continue
        unit = UNITS[_FIGURES[axis.partition("_")[0]][1]]
        shades = np.linspace(0.25, 1.0, steady.start.size)
        curves = tuple(
            Curve(
                f"from {start:.0f} s" if i in (0, steady.worst_part, steady.start.size - 1) else "", steady.averaging_time,
                deviation / unit.factor, tuple(int(c * shade) for c in AXIS_COLORS[axis[-1]]), style="curve",  # type: ignore[arg-type]
            )
            for i, (start, deviation, shade) in enumerate(zip(steady.start, steady.deviation, shades, strict=True))
        )  # fmt: skip
        title = f"{axis.replace('_', ' ')}: Allan deviation of {steady.start.size} parts, dark to light in time"
        review.figure(Figure(title, "averaging time [s]", f"Allan deviation [{unit.name}]", curves))
        return  # one is enough to see; the table names the others


def _other(result: Result) -> Figure:
    curves: list[Curve] = []
    unit = UNITS["deg/h"]
    for axis, found in result.axes.items():
        if found.other is None or not axis.startswith("gyro"):
            continue
        o, scale = found.other, 1 / unit.factor
        curves.append(
            Curve(
                axis.replace("_", " "),
                o.averaging_time,
                o.deviation * scale,
                AXIS_COLORS[axis[-1]],
                o.lower * scale,
                o.upper * scale,
            )
        )
    kind = next(found.other.kind for found in result.axes.values() if found.other is not None)
    return Figure(
        f"Gyroscopes: {kind} deviation", "averaging time [s]", f"{kind} deviation [{unit.name}]", tuple(curves)
    )


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

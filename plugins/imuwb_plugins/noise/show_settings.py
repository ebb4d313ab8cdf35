"""Figures and tables of a study of settings."""

import numpy as np

from imuwb.analysis import Curve, Figure, Review, Table, Vertical
from imuwb.colors import BLUE, color_at
from imuwb.texts import coefficient_text, quantity_text
from imuwb.units import UNITS, coefficient_units
from imuwb_plugins.noise.settings import TOLERANCE, CaseResult, Rule, Study

_SENSORS = {"gyro": ("Gyroscope", "deg/h"), "accel": ("Accelerometer", "m/s²")}


def draw_study(result: Study, review: Review) -> None:
    """Show the curves of all settings, the coefficients, and the rule."""
    for sensor in _SENSORS:
        if any(f"{sensor}_z" in c.axes for c in result.cases):
            review.figure(_curves(result, sensor))
    for rule in result.rule:
        if rule.axis.endswith("_z"):
            review.figure(_against_ratio(result, rule))
    review.table(_coefficients(result))
    if result.rule:
        review.table(_rules(result))


def _curves(result: Study, sensor: str) -> Figure:
    (name, unit), axis = _SENSORS[sensor], f"{sensor}_z"
    scale = 1 / UNITS[unit].factor
    curves = tuple(
        Curve(_text(c), c.axes[axis].averaging_time, c.axes[axis].allan_deviation * scale, color_at(i), style="curve")
        for i, c in enumerate(result.cases)
        if axis in c.axes
    )
    limits = tuple(
        Vertical(c.slowest[sensor], f"{c.settings['wavelet.levels']} levels", color_at(i))
        for i, c in enumerate(result.cases)
        if c.slowest and i in (0, len(result.cases) - 1)
    )
    return Figure(f"{name} z by setting", "averaging time [s]", f"Allan deviation [{unit}]", curves, verticals=limits)


def _against_ratio(result: Study, rule: Rule) -> Figure:
    unit, axis, name = coefficient_units(rule.axis, "N")[1], rule.axis, rule.axis.replace("_", " ")
    points = sorted(
        (c.ratio[axis.partition("_")[0]], *(unit.from_si(x) for x in (n.value, n.lower or 0.0, n.upper)))
        for c in result.cases
        if axis in c.axes and c.ratio and (n := c.axes[axis].coefficients["N"]).value is not None
    )
    x, value, lower, upper = np.array(points).T
    curve = Curve(name, x, value, BLUE, lower, upper, style="points")
    return Figure(
        f"{name}: random walk against rate / (2 bandwidth)", "rate / (2 bandwidth) [1]", f"N [{unit.name}]", (curve,),
        verticals=(Vertical(1.0, "rate = 2 bandwidth"),),
    )  # fmt: skip


def _text(case: CaseResult) -> str:
    return ", ".join(f"{key.removeprefix('wavelet.')} {value}" for key, value in case.settings.items())


def _coefficients(result: Study) -> Table:
    rows: list[tuple[str, ...]] = []
    for c in result.cases:
        for axis, r in c.axes.items():
            n, b, rate = (coefficient_units(axis, x)[1] for x in ("N", "B", "rate"))
            rows.append((
                _text(c), axis, f"{c.rate_hz[axis.partition('_')[0]]:.4g} Hz", coefficient_text(r.coefficients["N"], n),
                coefficient_text(r.coefficients["B"], b), f"{rate.from_si(r.deviation):.3g} {rate.name}",
                f"{r.per_step / n.factor**2:.3g} ({n.name})²",
            ))  # fmt: skip
    headings = (
        "setting", "axis", "rate", "N random walk", "B bias instability", "sigma of a sample", "sigma² × interval"
    )  # fmt: skip
    caption = (
        "N by likelihood, from the part of the spectrum where it is white. sigma² × interval is the value that a filter uses as Q "
        "(Hassaballa, eq. 11): equal to N² for white samples, less if the bandwidth is below half the rate."
    )
    return Table("Coefficients by setting", headings, tuple(rows), caption)


def _rules(result: Study) -> Table:
    rows = tuple(
        (
            r.axis, quantity_text((unit := coefficient_units(r.axis, "N")[1]).from_si(r.best), unit.name), f"{r.kept:.3f}",
            "—" if r.broken is None else f"{r.broken:.3f}", "yes" if r.holds else "no",
        )
        for r in result.rule
    )  # fmt: skip
    caption = (
        f"The rule: if the rate is at least twice the bandwidth, N is within {100 * TOLERANCE:g} % of its best value. At lower rates, "
        "noise is aliased and N grows."
    )
    headings = (
        "axis", "best N", "largest N over the best, rate ≥ 2 bandwidth [1]", "largest N over the best, lower rates [1]", "rule holds"
    )  # fmt: skip
    return Table("Is a rate of 2 × bandwidth enough?", headings, rows, caption)

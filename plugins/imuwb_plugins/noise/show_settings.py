"""Figures and tables of a study of settings."""

import numpy as np

from imuwb.analysis import Curve, Figure, Review, Table, Vertical
from imuwb.colors import BLUE, INK, color_at
from imuwb.texts import coefficient_text, estimate_text
from imuwb.units import UNITS, coefficient_units
from imuwb_plugins.noise.settings import TOLERANCE, Rule, Study, aliased

WIDEST = 8  #: settings of a table with a column for each
POINTS = 200
LETTERS = {"N": "random walk N", "B": "bias instability B", "Q": "quantization Q", "K": "rate random walk K"}
_SENSORS = {"gyro": ("Gyroscope", "deg/h"), "accel": ("Accelerometer", "m/s²")}


def draw_study(result: Study, review: Review) -> None:
    """Show the curves of all settings, the coefficients, and the rule."""
    for sensor in _SENSORS:
        if any(f"{sensor}_z" in c.axes for c in result.cases):
            review.figure(_curves(result, sensor))
    for rule in result.rule:
        if rule.axis.endswith("_z"):
            review.figure(_against_ratio(result, rule))
    if len(result.cases) <= WIDEST:
        review.table(_as_printed(result))
    review.table(_coefficients(result))
    if result.rule:
        review.table(_rules(result))


def _curves(result: Study, sensor: str) -> Figure:
    (name, unit), axis = _SENSORS[sensor], f"{sensor}_z"
    scale = 1 / UNITS[unit].factor
    curves = tuple(
        Curve(c.text, c.axes[axis].averaging_time, c.axes[axis].allan_deviation * scale, color_at(i), style="curve")
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
    line = np.geomspace(x.min() / 1.5, x.max() * 1.5, POINTS)
    curves = (
        Curve(name, x, value, BLUE, lower, upper, style="points"),
        Curve("white noise, aliased", line, unit.from_si(rule.best.value) * aliased(line), INK, style="fit"),
    )
    return Figure(
        f"{name}: random walk against rate / (2 bandwidth)", "rate / (2 bandwidth) [1]", f"N [{unit.name}], with its interval", curves,
        verticals=(Vertical(1.0, "rate = 2 bandwidth"),),
    )  # fmt: skip


def _as_printed(result: Study) -> Table:
    """Return the coefficients of the gyro z, or of the first axis, with a column for each setting (Hassaballa, table 2)."""
    axes = list(result.cases[0].axes)
    axis = "gyro_z" if "gyro_z" in axes else axes[0]
    cases = [c for c in result.cases if axis in c.axes]
    rows = tuple(
        (title, *(coefficient_text(c.axes[axis].coefficients[letter], unit) if letter in c.axes[axis].coefficients else "—" for c in cases))
        for letter, title in LETTERS.items()
        for unit in [coefficient_units(axis, letter)[1]]
    )  # fmt: skip
    caption = (
        f"{100 * result.level:g} % intervals; below a limit: the record does not show it (N/A in Hassaballa's table 2)."
    )
    return Table(
        f"{axis.replace('_', ' ')}: coefficients by setting", ("coefficient", *(c.text for c in cases)), rows, caption
    )


def _coefficients(result: Study) -> Table:
    rows: list[tuple[str, ...]] = []
    for c in result.cases:
        for axis, r in c.axes.items():
            n, b, rate = (coefficient_units(axis, x)[1] for x in ("N", "B", "rate"))
            rows.append((
                c.text, axis, f"{c.rate_hz[axis.partition('_')[0]]:.4g} Hz", coefficient_text(r.coefficients["N"], n),
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
            r.axis, estimate_text(r.best, (unit := coefficient_units(r.axis, "N")[1]).name, unit.factor), "—" if r.kept is None else estimate_text(r.kept, "", 1.0),
            "—" if r.broken is None else estimate_text(r.broken, "", 1.0), r.holds,
        )
        for r in result.rule
    )  # fmt: skip
    caption = (
        f"The rule (Hassaballa, 5.1): if the rate is at least twice the bandwidth, N is within {100 * TOLERANCE:g} % of its best value; at lower "
        f"rates, noise is aliased and N grows. {100 * result.level:g} % intervals; open: they do not decide; a dash: there are not two such settings."
    )
    headings = (
        "axis", "best N", "largest N over the best, rate ≥ 2 bandwidth [1]", "largest N over the best, lower rates [1]", "rule holds"
    )  # fmt: skip
    return Table("Is a rate of 2 × bandwidth enough?", headings, rows, caption)

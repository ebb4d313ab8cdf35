"""A study: the same noise through conditioners of many settings, such as rates and bandwidths (Hassaballa, 5.1 and table 2)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from imuwb.analysis import Curve, Figure, Table, Vertical
from imuwb.axes import axes_of, for_each, rates
from imuwb.errors import MissingDataError
from imuwb.identification import allan, fit_likelihood
from imuwb.identification.record.suitable import unsuitable
from imuwb.statistics import Coefficient
from imuwb.texts import coefficient_text
from imuwb.units import UNITS, coefficient_units

if TYPE_CHECKING:
    from collections.abc import Iterable

    from imuwb.analysis import Case, Review
    from imuwb.axes import Axis
    from imuwb.log import Floats

FEWEST = 256  #: samples
TOLERANCE = 0.1  #: of N, by which a setting may miss the best and still be called at full capacity
PALETTE = (
    (76, 120, 168),
    (242, 142, 43),
    (84, 162, 75),
    (228, 87, 86),
    (176, 122, 161),
    (118, 183, 178),
    (237, 201, 72),
    (156, 117, 95),
)
_SENSORS = {"gyro": ("Gyroscope", "deg/h"), "accel": ("Accelerometer", "m/s²")}


@dataclass(frozen=True, eq=False, slots=True)
class AxisCase:
    """One axis in one setting. SI."""

    averaging_time: Floats
    allan_deviation: Floats
    coefficients: dict[str, Coefficient]
    deviation: float  #: standard deviation of a sample, its slow drift taken off: √(Allan variance at one sample)
    per_step: float  #: sigma² times the sampling interval, what a filter takes for Q (Hassaballa, eq. 11)


@dataclass(frozen=True, eq=False, slots=True)
class CaseResult:
    """All axes in one setting."""

    settings: dict[str, str]
    rate_hz: dict[str, float]
    axes: dict[str, AxisCase]


@dataclass(frozen=True, eq=False, slots=True)
class Rule:
    """Whether N stays what it is as long as the rate is at least twice the bandwidth."""

    axis: str
    best: float  #: smallest N
    kept: float  #: largest N over the best, where rate >= 2 bandwidth
    broken: float | None  #: largest N over the best, where it is not; None: no such setting
    holds: bool


@dataclass(frozen=True, eq=False, slots=True)
class Study:
    """All settings."""

    level: float
    cases: tuple[CaseResult, ...]
    rule: tuple[Rule, ...]


def study(cases: Iterable[Case], level: float) -> Study:
    """Return the Allan deviation and the coefficients in each setting.

    Raises:
        MissingDataError: a setting leaves too few samples, or nothing that varies.
    """
    found = tuple(_case(case, level) for case in cases)
    return Study(level, found, _rule(found))


def _case(case: Case, level: float) -> CaseResult:
    axes = axes_of(case.log.imu())

    def one(axis: Axis) -> AxisCase | None:
        series, clock = axis.longest, axis.clock
        if unsuitable(series, FEWEST) is not None:
            return None
        curve = allan(series, clock.interval, "log:40", level=level, fast=True)
        coefficients = fit_likelihood(series, clock.interval, level=level).coefficients
        sigma = float(curve.deviation[0])
        return AxisCase(curve.averaging_time, curve.deviation, coefficients, sigma, sigma**2 * clock.interval)

    results = {name: r for name, r in for_each(axes, one).items() if r is not None}
    if not results:
        text = ", ".join(f"{k}={v}" for k, v in case.settings.items())
        message = (
            f"{case.log.provenance.path}, {text}: too few samples are left, or none that vary; a study needs {FEWEST}"
        )
        raise MissingDataError(message)
    return CaseResult(dict(case.settings), rates(axes), results)


def _rule(cases: tuple[CaseResult, ...]) -> tuple[Rule, ...]:
    """Test "rate = 2 × bandwidth" (Hassaballa, 5.1) where a study has both."""
    both = [c for c in cases if "bandwidth" in c.settings]
    if not both or len({c.settings["bandwidth"] for c in both}) * len({tuple(c.rate_hz.values()) for c in both}) < 4:  # noqa: PLR2004 - a grid
        return ()
    found: list[Rule] = []
    for axis in both[0].axes:
        sized: list[tuple[float, float]] = []
        for c in both:
            n = c.axes[axis].coefficients["N"].value if axis in c.axes else None
            if n is not None:
                sized.append((_ratio(c, axis), n))
        kept, broken = [n for r, n in sized if r >= 1], [n for r, n in sized if r < 1]
        if kept:
            best = min(kept)
            found.append(Rule(
                axis, best, max(kept) / best, max(broken) / best if broken else None,
                max(kept) / best < 1 + TOLERANCE and (not broken or max(broken) / best > 1 + TOLERANCE),
            ))  # fmt: skip
    return tuple(found)


def _ratio(case: CaseResult, axis: str) -> float:
    return case.rate_hz[axis.partition("_")[0]] / (2 * float(case.settings["bandwidth"]))


def draw(found: Study, review: Review) -> None:
    """Show curves over each other, coefficients by setting, and the rule."""
    for sensor, (name, unit) in _SENSORS.items():
        axis = f"{sensor}_z"
        if any(axis in c.axes for c in found.cases):
            review.figure(_curves(found, axis, name, unit))
    for rule in found.rule:
        if rule.axis.endswith("_z"):
            review.figure(_against_ratio(found, rule))
    review.table(_table(found))
    if found.rule:
        review.table(_rules(found))


def _curves(found: Study, axis: str, name: str, unit: str) -> Figure:
    scale = 1 / UNITS[unit].factor
    curves = tuple(
        Curve(
            _text(c),
            c.axes[axis].averaging_time,
            c.axes[axis].allan_deviation * scale,
            PALETTE[i % len(PALETTE)],
            style="curve",
        )
        for i, c in enumerate(found.cases)
        if axis in c.axes
    )
    limits = tuple(
        Vertical(
            2.0 ** (int(levels) + 1) / c.rate_hz[axis.partition("_")[0]], f"{levels} levels", PALETTE[i % len(PALETTE)]
        )
        for i, c in enumerate(found.cases)
        if (levels := c.settings.get("wavelet.levels", "")).isdecimal() and i in (0, len(found.cases) - 1)
    )
    return Figure(f"{name} z by setting", "averaging time [s]", f"Allan deviation [{unit}]", curves, verticals=limits)


def _against_ratio(found: Study, rule: Rule) -> Figure:
    unit = coefficient_units(rule.axis, "N")[1]
    points = sorted(
        (_ratio(c, rule.axis), n.value, n.lower, n.upper)
        for c in found.cases
        if rule.axis in c.axes
        and "bandwidth" in c.settings
        and (n := c.axes[rule.axis].coefficients["N"]).value is not None
    )
    x, value, lower, upper = (
        np.array([unit.from_si(p) if k else p for p in column]) for k, column in enumerate(zip(*points, strict=True))
    )
    curve = Curve(rule.axis.replace("_", " "), x, value, PALETTE[0], lower, upper, style="points")
    return Figure(
        f"{rule.axis.replace('_', ' ')}: random walk against rate / (2 bandwidth)", "rate / (2 bandwidth) [1]", f"N [{unit.name}]", (curve,),
        verticals=(Vertical(1.0, "rate = 2 bandwidth"),),
    )  # fmt: skip


def _text(case: CaseResult) -> str:
    return ", ".join(f"{key.removeprefix('wavelet.')} {value}" for key, value in case.settings.items())


def _table(found: Study) -> Table:
    rows: list[tuple[str, ...]] = []
    for c in found.cases:
        for axis, r in c.axes.items():
            n, unit = r.coefficients["N"], coefficient_units(axis, "N")[1]
            rate = coefficient_units(axis, "rate")[1]
            b = coefficient_text(r.coefficients["B"], coefficient_units(axis, "B")[1])
            step = f"{r.per_step / unit.factor**2:.3g} ({unit.name})²"
            rows.append(
                (
                    _text(c),
                    axis,
                    f"{c.rate_hz[axis.partition('_')[0]]:.4g} Hz",
                    coefficient_text(n, unit),
                    b,
                    f"{rate.from_si(r.deviation):.3g} {rate.name}",
                    step,
                )
            )
    headings = (
        "setting",
        "axis",
        "rate",
        "N random walk",
        "B bias instability",
        "sigma of a sample",
        "sigma² × interval",
    )
    caption = (
        "N from the part of the spectrum where it is white, by likelihood. sigma² × interval is what a filter takes for Q (Hassaballa, eq. 11): equal to N² "
        "where the samples are white, less where the bandwidth is below half the rate."
    )
    return Table("Coefficients by setting", headings, tuple(rows), caption)


def _rules(found: Study) -> Table:
    rows = tuple(
        (
            r.axis, coefficient_text(Coefficient(r.best, None, 0.0), coefficient_units(r.axis, "N")[1]).partition(" [")[0] + f" {coefficient_units(r.axis, 'N')[1].name}",
            f"{100 * (r.kept - 1):+.1f} %", "—" if r.broken is None else f"{100 * (r.broken - 1):+.1f} %", "yes" if r.holds else "no",
        )
        for r in found.rule
    )  # fmt: skip
    caption = f"The rule: as long as the rate is at least twice the bandwidth, N is within {100 * TOLERANCE:g} % of its best; below, noise folds down and N grows."
    return Table(
        "Rate ≈ 2 × bandwidth?",
        ("axis", "best N", "worst with rate ≥ 2 bandwidth", "worst below", "rule holds"),
        rows,
        caption,
    )

"""A study: the same noise after conditioners of many settings, such as rates and bandwidths (Hassaballa, 5.1 and table 2)."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from imuwb.analysis import Case, setting_text
from imuwb.arrays import Floats
from imuwb.axes import Axis, axes_of, for_each, rates
from imuwb.errors import MissingDataError
from imuwb.identification import allan, fit_likelihood
from imuwb.identification.record.suitable import unsuitable
from imuwb.statistics import Coefficient, Estimate
from imuwb.texts import counted
from imuwb_plugins.noise.parameters import Parameters

FEWEST = 256  #: samples
TOLERANCE = 0.1  #: excess of N over the best, up to which a setting keeps the sensor's full capacity
ALIASES = 200  #: multiples of the rate whose noise is added
GRID = 4  #: fewest settings of rate and bandwidth for a test of the rule


@dataclass(frozen=True, eq=False, slots=True)
class AxisCase:
    """One axis in one setting. SI."""

    averaging_time: Floats
    allan_deviation: Floats
    coefficients: dict[str, Coefficient]
    deviation: float  #: standard deviation of a sample without its slow drift: √(Allan variance at one sample)
    per_step: float  #: sigma² times the sampling interval, which a filter uses as Q (Hassaballa, eq. 11)


@dataclass(frozen=True, eq=False, slots=True)
class CaseResult:
    """All axes in one setting."""

    settings: dict[str, str]
    rate_hz: dict[str, float]
    axes: dict[str, AxisCase]
    ratio: dict[str, float]  #: sensor -> rate / (2 bandwidth); empty if the setting has no bandwidth
    slowest: dict[str, float]  #: sensor -> s, motion must be slower; empty if the setting has no denoising
    text: str = field(metadata={"document": False})  #: the setting, for people


@dataclass(frozen=True, eq=False, slots=True)
class Rule:
    """Test of the rule that N stays the same if the rate is at least twice the bandwidth."""

    axis: str
    best: Estimate  #: smallest N
    #: largest N over the best, at rates of at least twice the bandwidth; None: only one setting has such a rate
    kept: Estimate | None
    broken: Estimate | None  #: largest N over the best, at lower rates; None: no such setting
    holds: Literal["yes", "no", "open"]  #: open: the intervals do not decide


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class Study:
    """All settings."""

    level: float
    cases: tuple[CaseResult, ...]
    rule: tuple[Rule, ...]

    def __repr__(self) -> str:
        """Return the number of settings, and where the rule holds."""
        held = ", ".join(f"{r.axis} {r.holds}" for r in self.rule) or "not tested"
        return f"noise in {counted(len(self.cases), 'setting')}; rate = 2 × bandwidth is enough: {held}"


def study(cases: Iterable[Case], parameters: Parameters) -> Study:
    """Return the Allan deviation and the coefficients in each setting.

    Raises:
        MissingDataError: a setting leaves too few samples, or constant channels.
    """
    results = tuple(_case(case, parameters.level) for case in cases)
    return Study(parameters.level, results, rule(results))


def _case(case: Case, level: float) -> CaseResult:
    axes = axes_of(case.log.imu())
    results = {name: r for name, r in for_each(axes, lambda axis: _axis(axis, level)).items() if r is not None}
    if not results:
        setting = setting_text(case.settings, case.units)
        raise MissingDataError(
            f"{case.log.provenance.path}, {setting}: fewer than {FEWEST} samples are left, or all channels are constant; "
            "leave this setting out"
        )
    rate = rates(axes)
    ratio, slowest = _ratio(case.settings, rate), _slowest(case.settings, rate)
    return CaseResult(dict(case.settings), rate, results, ratio, slowest, setting_text(case.settings, case.units))


def _axis(axis: Axis, level: float) -> AxisCase | None:
    series, dt = axis.longest, axis.clock.interval
    if unsuitable(series, FEWEST) is not None:
        return None
    curve = allan(series, dt, "log:40", level=level, fast=True)
    coefficients = fit_likelihood(series, dt, level=level).coefficients
    sigma = float(curve.deviation[0])
    return AxisCase(curve.averaging_time, curve.deviation, coefficients, sigma, sigma**2 * dt)


def _ratio(settings: Mapping[str, str], rate_hz: Mapping[str, float]) -> dict[str, float]:
    if "bandwidth" not in settings:
        return {}
    return {sensor: rate / (2 * float(settings["bandwidth"])) for sensor, rate in rate_hz.items()}


def _slowest(settings: Mapping[str, str], rate_hz: Mapping[str, float]) -> dict[str, float]:
    levels = settings.get("wavelet.levels", "")
    return {sensor: 2.0 ** (int(levels) + 1) / rate for sensor, rate in rate_hz.items()} if levels.isdecimal() else {}


def rule(cases: tuple[CaseResult, ...]) -> tuple[Rule, ...]:
    """Return the test of "rate = 2 × bandwidth" (Hassaballa, 5.1) for each axis; empty if the study is no grid of both."""
    both = [c for c in cases if c.ratio]
    grid = len({c.settings["bandwidth"] for c in both}) * len({tuple(c.rate_hz.values()) for c in both})
    if grid < GRID:
        return ()
    rules: list[Rule] = []
    for axis in both[0].axes:
        sized = [
            (c.ratio[axis.partition("_")[0]], found)
            for c in both
            if axis in c.axes and (found := _estimate(c.axes[axis].coefficients["N"])) is not None
        ]
        kept, broken = [n for r, n in sized if r >= 1], [n for r, n in sized if r < 1]
        if kept:
            best = min(kept, key=_value)
            most = _over(max(kept, key=_value), best) if len(kept) > 1 else None
            worst = _over(max(broken, key=_value), best) if broken else None
            rules.append(Rule(axis, best, most, worst, _verdict(most, worst)))
    return tuple(rules)


def _value(n: Estimate) -> float:
    return n.value


def _estimate(n: Coefficient) -> Estimate | None:
    """Return a coefficient as an estimate; None if the record does not show it."""
    return None if n.value is None or not n.lower else Estimate(n.value, n.lower, n.upper)


def _over(n: Estimate, best: Estimate) -> Estimate:
    """Return the ratio of two coefficients, with its interval: the settings share a record, and are taken as independent."""
    ratio = n.value / best.value
    down = math.hypot(math.log(n.value / n.lower), math.log(best.upper / best.value))
    up = math.hypot(math.log(n.upper / n.value), math.log(best.value / best.lower))
    return Estimate(ratio, ratio * math.exp(-down), ratio * math.exp(up), unit="1")


def _verdict(kept: Estimate | None, broken: Estimate | None) -> Literal["yes", "no", "open"]:
    """Return whether N stays within the tolerance at high rates, and exceeds it at low ones."""
    limit = 1 + TOLERANCE
    if (kept is not None and kept.lower > limit) or (broken is not None and broken.upper < limit):
        return "no"
    inside = (kept is None or kept.upper < limit) and (broken is None or broken.lower > limit)
    return "yes" if inside and not (kept is None and broken is None) else "open"


def aliased(ratio: Floats) -> Floats:
    """Return N of white noise after a Butterworth low-pass of second order, over N before it, by rate / (2 bandwidth).

    At low frequencies, the spectrum of the samples is the sum of the spectrum before at all multiples of the rate.

    Args:
        ratio: (n,) rate over twice the bandwidth.
    """
    multiples = np.arange(1, ALIASES + 1)
    return np.sqrt(1 + 2 * (1 / (1 + (2 * ratio[:, None] * multiples) ** 4)).sum(axis=1))

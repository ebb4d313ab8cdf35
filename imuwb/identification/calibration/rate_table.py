"""Gyros on a rate table: bias, scale factor, its non-linear part, and cross-couplings (Hassaballa, 3.1)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import special

from imuwb.arrays import Floats
from imuwb.geodesy.earth import EARTH_RATE
from imuwb.identification.calibration.axis_calibration import AxisCalibration, student_estimate
from imuwb.identification.calibration.least_squares import LinearFit, RowNoise, fit_linear, is_determined
from imuwb.identification.calibration.means import Means
from imuwb.identification.calibration.static_gyros import MIDDLE
from imuwb.statistics import Estimate

DISAGREEING = 0.05  #: probability of the scatter between runs, below which their common interval is widened


@dataclass(frozen=True, eq=False, slots=True)
class RateRun:
    """One run of the rate table, with one axis along the table's axis."""

    name: str
    axis: int  #: number of the gyro that turns
    rate: Floats  #: (k,) rad/s, of the table in each step
    length: Floats  #: (k,) s
    means: Means  #: means of the gyros in k steps
    up: float | None = None  #: +1: the turned axis points up, -1: down, 0: horizontal; None: not known


@dataclass(frozen=True, eq=False, slots=True)
class RunFit:
    """The fit of one run."""

    offset: tuple[Estimate, Estimate, Estimate]  #: of each gyro at rest in this attitude, in the unit of the samples
    residual: Floats  #: (k, 3)
    sigma: Floats  #: (k, 3) standard deviation of the means' noise


@dataclass(frozen=True, eq=False, slots=True)
class RateTableCalibration:
    """The calibration of the gyros from several runs of a rate table."""

    axes: tuple[AxisCalibration, AxisCalibration, AxisCalibration]
    runs: tuple[RunFit, ...]  #: fits in the order of the given runs


@dataclass(frozen=True, slots=True)
class TableConditions:
    """The known conditions of the rate table, and the level of the intervals."""

    latitude: float | None = None  #: rad; None: not known
    misplacement: float = 0.0  #: rad, rms angle between the sensor's axis and the table's
    full_range: float | None = None  #: rad/s, range that defines the non-linear part; None: no non-linear part
    forces_known: bool = False  #: g-sensitivity is already subtracted: the offsets of all runs are the same bias
    level: float = 0.95


def rate_table(runs: Sequence[RateRun], conditions: TableConditions) -> RateTableCalibration:
    """Return the gyros' calibration; an axis that no run turns has only a bias and couplings.

    The offset of a run includes the g-sensitivity to the specific force in its attitude. So the bias is the mean over the runs,
    with an interval from their scatter, unless the forces are known. With a single run, the bias is that in its attitude.

    Args:
        runs: each with one axis along the vertical axis of the table; several runs may turn the same axis.
        conditions: conditions of the table.

    Raises:
        ValueError: the steps of a run do not separate its offset from its scale factor.
    """
    fits = [[_fit(run, axis, conditions) for axis in range(3)] for run in runs]
    axes = tuple(_axis(axis, runs, [fit[axis] for fit in fits], conditions) for axis in range(3))
    run_fits = tuple(
        RunFit(
            tuple(fit.estimate(0, conditions.level) for fit in three),  # type: ignore[arg-type]
            np.stack([fit.residual for fit in three], axis=1),
            np.sqrt(run.means.variance),
        )
        for run, three in zip(runs, fits, strict=True)
    )
    return RateTableCalibration(axes, run_fits)  # type: ignore[arg-type]


def bends(rate: Floats, full_range: float | None) -> bool:
    """Return whether rates separate a non-linear scale factor from the linear one: at least two magnitudes and four rates."""
    return full_range is not None and np.unique(np.abs(rate[rate != 0])).size > 1 and rate.size > 3  # noqa: PLR2004 - one more than parameters


def _fit(run: RateRun, axis: int, conditions: TableConditions) -> LinearFit:
    columns = [np.ones_like(run.rate), run.rate]
    if axis == run.axis and bends(run.rate, conditions.full_range):
        columns.append(run.rate * np.abs(run.rate) / (conditions.full_range or 1.0))
    design = np.stack(columns, axis=1)
    if not is_determined(design):
        raise ValueError(
            f"{run.name}: {np.unique(run.rate).size} different rates do not separate bias and scale factor; turn the table both ways"
        )
    earth = _earth_across(run, conditions) if axis != run.axis else np.zeros_like(run.rate)
    variance = run.means.variance[:, axis]
    count = run.rate.size
    noise = RowNoise(variance + earth, np.zeros(count, dtype=np.int64), np.full(count, run.means.freedom[axis]))
    value = run.means.value[:, axis] - (_vertical(run, conditions) if axis == run.axis else 0.0)
    return fit_linear(design, value, noise, np.ones(count), always=False)


def _vertical(run: RateRun, conditions: TableConditions) -> float:
    """Return the known part of the earth's rate along the turned axis, rad/s."""
    if conditions.latitude is None or run.up is None:
        return 0.0
    return EARTH_RATE * float(np.sin(conditions.latitude)) * run.up


def _earth_across(run: RateRun, conditions: TableConditions) -> Floats:
    """Return the variance of a step's mean that the earth's horizontal rate causes; it rotates relative to the turning sensor."""
    horizontal = EARTH_RATE * (MIDDLE if conditions.latitude is None else float(np.cos(conditions.latitude)))
    left = np.minimum(1.0, 2 / np.maximum(np.abs(run.rate) * run.length, 1e-12))
    return (horizontal * left) ** 2 / 2


def _axis(
    axis: int, runs: Sequence[RateRun], fits: Sequence[LinearFit], conditions: TableConditions
) -> AxisCalibration:
    level = conditions.level
    own = [fit for run, fit in zip(runs, fits, strict=True) if run.axis == axis]
    scale = _joined([(fit.value[1] - 1, fit.covariance[1, 1], fit.freedom[1]) for fit in own], level)
    bent = [(fit.value[2], fit.covariance[2, 2], fit.freedom[2]) for fit in own if len(fit.value) > 2]  # noqa: PLR2004 - offset, gain, bend
    crossed: list[Estimate | None] = []
    for other in (k for k in range(3) if k != axis):
        tilt = conditions.misplacement**2 * _gain(fits, runs, axis) ** 2
        rows = [
            (fit.value[1], fit.covariance[1, 1] + tilt, _with_known(fit.covariance[1, 1], tilt, float(fit.freedom[1])))
            for run, fit in zip(runs, fits, strict=True)
            if run.axis == other
        ]
        crossed.append(_joined(rows, level))
    return AxisCalibration(_bias(axis, runs, fits, conditions), scale, _joined(bent, level), (crossed[0], crossed[1]))


def _gain(fits: Sequence[LinearFit], runs: Sequence[RateRun], axis: int) -> float:
    """Return the gain of an axis, which converts a tilt to a coupling; 1 if it is not known."""
    own = [float(fit.value[1]) for run, fit in zip(runs, fits, strict=True) if run.axis == axis]
    return own[0] if own else 1.0


def _with_known(variance: float, known: float, freedom: float) -> float:
    """Return the degrees of freedom of a variance plus a known variance."""
    return freedom * ((variance + known) / variance) ** 2 if variance > 0 else 1e6


def _bias(axis: int, runs: Sequence[RateRun], fits: Sequence[LinearFit], conditions: TableConditions) -> Estimate:
    unknown = [
        (EARTH_RATE * MIDDLE) ** 2 if run.axis == axis and (conditions.latitude is None or run.up is None) else 0.0
        for run in runs
    ]
    rows = [
        (fit.value[0], fit.covariance[0, 0] + more, float(fit.freedom[0]))
        for fit, more in zip(fits, unknown, strict=True)
    ]
    if len(rows) == 1 or conditions.forces_known:
        bias = _joined(rows, conditions.level)
        assert bias is not None  # noqa: S101 - there is at least one run
        return bias
    offsets = np.array([value for value, *_ in rows])
    spread = float(offsets.var(ddof=1)) / offsets.size
    inner = sum(variance for _, variance, _ in rows) / len(rows) ** 2
    # The scatter includes the noise; by chance the estimate of the scatter can be smaller than the noise.
    return student_estimate(float(offsets.mean()), max(spread, inner), len(rows) - 1, conditions.level)


def _joined(rows: Sequence[tuple[float, float, float]], level: float) -> Estimate | None:
    """Return the weighted mean of (value, variance, degrees of freedom); None if there are none.

    If the values differ by more than their variances explain (chi-square test, 5 %), the variance is scaled up to match.
    """
    if not rows:
        return None
    value, variance, freedom = (np.array(part, dtype=np.float64) for part in zip(*rows, strict=True))
    weight = 1 / np.maximum(variance, np.finfo(float).tiny * 1e20)
    mean = float(weight @ value / weight.sum())
    own = 1 / weight.sum()
    degrees = own**2 / float(((weight / weight.sum()) ** 4 * variance**2 / freedom).sum())
    square, rest = float(weight @ (value - mean) ** 2), len(rows) - 1
    if rest and special.chdtrc(rest, square) < DISAGREEING:
        return student_estimate(mean, own * square / rest, rest, level)
    return student_estimate(mean, own, degrees, level)

"""Gyros from the motions between still positions: scale factors, couplings, bias and g-sensitivity.

While a sensor is still, its accelerometers show the direction of up. The gyros, integrated over the motion to the next position,
must turn the direction before into the direction after (Tedaldi, Pretto and Menegatti 2014). The frame is that of the accelerometers.

The differences are weighted by the noise of the gyros over the motion, that of the accelerometers in both windows, and the
uncertain parameters of the accelerometers. How large they are in all is estimated from the differences themselves.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from imuwb.arrays import Floats
from imuwb.geodesy.earth import EARTH_RATE
from imuwb.identification.calibration.axis_calibration import AxisCalibration
from imuwb.identification.calibration.earth_rows import earth_rows
from imuwb.identification.calibration.least_squares import LinearFit, RowNoise, fit_linear
from imuwb.identification.calibration.means import Means
from imuwb.identification.calibration.motions import PARAMETERS, Integral, Motion, Triad, integral
from imuwb.identification.calibration.positions import PositionCalibration
from imuwb.identification.calibration.static_gyros import static_fit

FEWEST = 6  #: motions; each gives two equations, and nine parameters and their noise are unknown
CLOSE = 1e-9  #: relative change of the gains at which the iteration ends
MOST_TURNS = 30  #: largest number of iterations
WEAKEST = 0.02  #: ratio of singular values of the gains' columns, below which the motions turn about too few axes
SHORTEST = 0.5  #: s, shortest window
TURNS = (0.3, 30.0)  #: rad/s, smallest and largest plausible rate of a motion by hand, for a log in counts or volts
GAINS = 60  #: gains that are tried for a log in counts or volts
TRIED = 12  #: motions with which they are tried
WRONG = 0.2  #: rad, rms difference above which the gyros do not measure the motions at all
WRONG_TEXT = (
    "the gyros do not measure the motions that the accelerometers show; check the units, the axes and their signs"
)
CROOKED = 100.0  #: condition number of the gains above which the iteration has gone astray
SILENT = 1e-10  #: least variance of a still gyro, over that of the motion
TINY = 1e-6  #: variance of a weighted difference, next to the estimated one


@dataclass(frozen=True, eq=False, slots=True)
class MovedGyros:
    """The calibration of the gyros from M motions."""

    axes: tuple[AxisCalibration, AxisCalibration, AxisCalibration]
    apart: Floats  #: (M,) rad, angle between the direction of up after a motion and the integrated one
    window: float  #: s, longest window in which the direction of up was measured
    excess: float  #: rms of the differences over what the known noise explains


@dataclass(frozen=True, eq=False, slots=True)
class _Known:
    """What is known before the motions are looked at."""

    accel: Triad
    accel_covariance: Floats  #: (12, 12)
    gyro: Means  #: means of the gyros in the P positions
    up: Floats  #: (P, 3)
    still: LinearFit  #: bias and sensitivity to up from the positions alone
    density: float  #: (unit of the samples)²/Hz of the gyros in the quietest position
    seconds: Floats  #: (P,)
    accel_density: float  #: (m/s²)²/Hz of the accelerometers along up
    gravity: float
    latitude: float | None


def moved_gyros(
    motions: Sequence[Motion],
    gyro: Means,
    seconds: Floats,
    still: PositionCalibration,
    gravity: float,
    level: float,
    latitude: float | None,
    *,
    raw: bool = False,
) -> MovedGyros:
    """Return scale factors and all couplings of the gyros, and bias and g-sensitivity improved by the motions.

    Args:
        motions: at least 6, between neighbouring positions.
        gyro: means of the gyros in the P positions.
        seconds: (P,) s, durations of the positions.
        still: calibration of the accelerometers without attitudes.
        gravity: m/s².
        level: confidence level of the intervals.
        latitude: rad; None: not known.
        raw: whether the samples are in counts or volts.

    Raises:
        ValueError: too few motions, motions about too few axes, or gyros that do not measure the motions.
    """
    if len(motions) < FEWEST:
        raise ValueError(f"{len(motions)} motions between neighbouring positions; {FEWEST} or more are needed")
    known = _known(motions, gyro, seconds, still, gravity, latitude)
    gain = _first_gain(motions, known) if raw else np.eye(3)
    window = _window(known, gain)
    cut = [m.trimmed(window) for m in motions]
    try:
        value, parts, fit = _fitted(cut, _joined_parameters(known.still.value, gain), known)
    except np.linalg.LinAlgError as error:
        raise ValueError(WRONG_TEXT) from error
    apart = np.array([float(np.linalg.norm(p.apart)) for p in parts])
    if not float(np.sqrt((apart**2).mean())) < WRONG:
        raise ValueError(WRONG_TEXT)
    axes = tuple(_axis(fit, value, axis, gravity, level) for axis in range(3))
    return MovedGyros(axes, apart, window, fit.extra**0.5)  # type: ignore[arg-type]


def _known(
    motions: Sequence[Motion],
    gyro: Means,
    seconds: Floats,
    still: PositionCalibration,
    gravity: float,
    latitude: float | None,
) -> _Known:
    if still.covariance is None:
        raise ValueError("motions need the calibration of the accelerometers without attitudes")
    up = still.force / gravity
    # A coarse gyro may show no noise at all while it is still.
    density = min(
        float(max(m.gyro[: m.first].var(axis=0).mean(), SILENT * m.gyro.var()) * m.step.mean()) for m in motions
    )
    gain = np.zeros((3, 3))
    for i, axis in enumerate(still.axes):
        assert axis.scale_factor is not None  # noqa: S101 - this method determines it
        gain[i] = np.insert(
            [0.0 if c is None else c.value for c in axis.cross_coupling], i, 1 + axis.scale_factor.value
        )
    bias = np.array([0.0 if axis.bias is None else axis.bias.value for axis in still.axes])
    force = float((still.sigma**2 * seconds[:, None] / np.diag(gain) ** 2).mean())
    return _Known(
        Triad(gain, bias),
        still.covariance,
        gyro,
        up,
        static_fit(gyro, up, latitude),
        density,
        seconds,
        force,
        gravity,
        latitude,
    )


def _gains() -> list[int]:
    """Return the places of the nine gains in the parameters."""
    return [PARAMETERS * axis + 4 + k for axis in range(3) for k in range(3)]


def _joined_parameters(still: Floats, gain: Floats) -> Floats:
    """Return the 21 parameters: bias, sensitivity to up and gains of each gyro."""
    return np.concatenate([still.reshape(3, 4), gain], axis=1).ravel()


def _gyro(value: Floats) -> tuple[Triad, Floats]:
    rows = value.reshape(3, PARAMETERS)
    return Triad(rows[:, 4:], rows[:, 0]), rows[:, 1:4]


def _window(known: _Known, gain: Floats) -> float:
    """Return the window, s, that gives the directions the least noise: a longer one has more noise of the gyros."""
    gyro = known.density**0.5 / float(np.abs(np.diag(gain)).mean())
    return max((2 * known.accel_density) ** 0.5 / known.gravity / max(gyro, 1e-12), SHORTEST)


def _first_gain(motions: Sequence[Motion], known: _Known) -> Floats:
    """Return the common gain, in counts or volts per rad/s, that explains the motions best."""
    some = [m.trimmed(SHORTEST) for m in motions[:: max(len(motions) // TRIED, 1)]]
    bias = known.still.value.reshape(3, 4)[:, 0]
    largest = max(float(np.abs(m.gyro - bias).max()) for m in some)

    def apart(gain: float) -> float:
        value = _joined_parameters(known.still.value, gain * np.eye(3))
        return sum(float((integral(m, *_gyro(value), known.accel, known.gravity).apart ** 2).sum()) for m in some)

    return min(np.geomspace(largest / TURNS[1], largest / TURNS[0], GAINS), key=apart) * np.eye(3)


def _fitted(motions: Sequence[Motion], value: Floats, known: _Known) -> tuple[Floats, list[Integral], LinearFit]:
    """Return the parameters that explain the motions, the motions' integrals with them, and the fit of the last change."""
    parts = [integral(m, *_gyro(value), known.accel, known.gravity) for m in motions]
    _check_axes(parts)
    for _ in range(MOST_TURNS):
        fit = _fit(motions, parts, value, known)
        change = float(np.abs(fit.value[_gains()]).max() / np.abs(value[_gains()]).max())
        value = value + fit.value[: value.size]
        if not np.isfinite(change) or np.linalg.cond(_gyro(value)[0].gain) > CROOKED:
            break
        if change < CLOSE:
            return value, parts, fit
        parts = [integral(m, *_gyro(value), known.accel, known.gravity) for m in motions]
    raise ValueError(WRONG_TEXT)


def _check_axes(parts: Sequence[Integral]) -> None:
    """Raise ValueError if the motions do not separate the nine gains."""
    gains = np.concatenate([p.slope for p in parts])[:, _gains()]
    size = np.linalg.norm(gains, axis=0)
    singular = np.linalg.svd(gains / np.maximum(size, np.finfo(float).tiny), compute_uv=False)
    if not np.isfinite(singular).all() or singular[-1] < WEAKEST * singular[0]:
        raise ValueError("the motions turn the sensor about too few axes; turn it about all three, one way and back")


def _fit(motions: Sequence[Motion], parts: Sequence[Integral], value: Floats, known: _Known) -> LinearFit:
    """Return the fit of the change of the 21 parameters, followed by those of the earth's rate."""
    slope = np.concatenate([p.slope for p in parts])
    own, left = _still_rows(value, known)
    earth, prior = earth_rows(motions, parts, _gyro(value)[0].gain, known.up, known.latitude)
    design = np.concatenate([np.concatenate([own, slope]), earth], axis=1)
    y = np.concatenate([left, -np.concatenate([p.apart for p in parts])])
    root = np.linalg.cholesky(_covariance(motions, parts, known))
    guess = np.concatenate([np.zeros((len(prior), own.shape[1])), np.diag(1 / prior)], axis=1)
    whole = np.asarray(np.concatenate([np.linalg.solve(root, design), guess]), dtype=np.float64)
    measured = np.asarray(np.concatenate([np.linalg.solve(root, y), np.zeros(len(prior))]), dtype=np.float64)
    moved = np.zeros(len(measured), dtype=np.bool_)
    moved[len(left) : len(y)] = True
    freedom = np.where(np.arange(len(moved)) < len(left), float(known.gyro.freedom.sum()), 1e6)
    noise = RowNoise(np.where(moved, TINY, 1.0), np.where(moved, 0, 1), freedom)
    return fit_linear(whole, measured, noise, moved.astype(np.float64), always=True)


def _still_rows(value: Floats, known: _Known) -> tuple[Floats, Floats]:
    """Return the design of the gyros' means, (3 P, 21), position by position, and what the parameters leave of the means, (3 P,)."""
    positions = len(known.up)
    row = np.concatenate([np.ones((positions, 1)), known.up, np.zeros((positions, 3))], axis=1)
    design = np.einsum("pk,ij->pijk", row, np.eye(3)).reshape(3 * positions, 3 * PARAMETERS)
    triad, _ = _gyro(value)
    vertical = 0.0 if known.latitude is None else EARTH_RATE * float(np.sin(known.latitude))
    left = known.gyro.value - vertical * known.up @ triad.gain.T
    return design, left.ravel() - design @ value


def _covariance(motions: Sequence[Motion], parts: Sequence[Integral], known: _Known) -> Floats:
    """Return the covariance of the gyros' means and of the differences of all motions, (3 P + 2 M, 3 P + 2 M)."""
    first = 3 * len(known.up)
    accel = np.concatenate([p.accel_slope for p in parts])
    whole = np.zeros((first + len(accel), first + len(accel)))
    whole[first:, first:] = accel @ known.accel_covariance @ accel.T
    still = np.maximum(known.gyro.variance, known.density / known.seconds[:, None]) + known.still.extra
    whole[np.arange(first), np.arange(first)] = still.ravel()
    for i, (m, p) in enumerate(zip(motions, parts, strict=True)):
        here = slice(first + 2 * i, first + 2 * i + 2)
        dt = float(m.step.mean())
        whole[here, here] += p.gyro_noise * known.density
        for end, samples in zip(p.ends, (m.last, m.first), strict=True):
            whole[here, here] += known.accel_density * end @ end.T / (samples * dt)
        for number, swing in zip((m.before, m.before + 1), p.swings, strict=True):
            # The samples of a position are in its mean, and in the motions before and after it.
            there = slice(3 * number, 3 * number + 3)
            whole[here, there] = known.density * swing
            whole[there, here] = whole[here, there].T
        if i + 1 < len(parts) and motions[i + 1].before == m.before + 1:
            after = slice(here.stop, here.stop + 2)
            shared = known.accel_density * p.ends[0] @ parts[i + 1].ends[1].T * _overlap(m, motions[i + 1], dt)
            whole[here, after] -= shared
            whole[after, here] -= shared.T
    return whole


def _overlap(before: Motion, after: Motion, dt: float) -> float:
    """Return the covariance of the means of two windows of one position, for a noise of density 1, 1/s."""
    both = min(before.last + after.first - before.held, before.last, after.first)
    return max(both, 0) / (before.last * after.first * dt)


def _axis(fit: LinearFit, value: Floats, axis: int, gravity: float, level: float) -> AxisCalibration:
    """Return one gyro's parameters: the value of the last iteration with the interval of its last change."""
    first = PARAMETERS * axis

    def estimate(place: int, factor: float = 1.0):  # noqa: ANN202 - an Estimate
        e = fit.estimate(first + place, level, factor)
        shift = factor * float(value[first + place]) - e.value
        return replace(e, value=e.value + shift, lower=e.lower + shift, upper=e.upper + shift)

    others = [k for k in range(3) if k != axis]
    return AxisCalibration(
        estimate(0), estimate(4 + axis).shifted(-1.0), None, (estimate(4 + others[0]), estimate(4 + others[1])),
        (estimate(1, 1 / gravity), estimate(2, 1 / gravity), estimate(3, 1 / gravity)),
    )  # fmt: skip

"""From logs with still positions to the calibration of their sensors, by six-position or multi-position."""

import csv
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from imuwb.arrays import Floats
from imuwb.errors import MissingDataError, UsageError
from imuwb.estimators.calibration import before_logging
from imuwb.geodesy.earth import gravity as normal_gravity
from imuwb.identification import calibration
from imuwb.identification.calibration import Means, PositionCalibration, PrintedCalibration
from imuwb.log import Log
from imuwb.stochastic import ImuErrorModel
from imuwb.units import STANDARD_GRAVITY
from imuwb_plugins.calibration.corrected_samples import position_traces
from imuwb_plugins.calibration.error_model import (
    check_gain,
    completed_model,
    full_range_of,
    parameters_of,
    provenance_of,
)
from imuwb_plugins.calibration.gyros import calibrated_gyros
from imuwb_plugins.calibration.notes import position_notes, red_notes
from imuwb_plugins.calibration.parameters import MultiPosition, SixPosition
from imuwb_plugins.calibration.result import Position, PositionResult
from imuwb_plugins.calibration.stretches import (
    SteadyStretch,
    check_clipping,
    check_still,
    still_positions,
    temperature_of,
    unit_of_counts,
)

RANGES = (2, 4, 8, 16, 32, 64, 128)  #: g, usual full ranges
STRANGE = 0.2  #: share of the means' variation left in the residuals, above which the attitudes are wrong


def run(logs: Sequence[Log], p: SixPosition | MultiPosition) -> PositionResult:
    """Return the calibration.

    Raises:
        MissingDataError: a log without accelerometer or without still positions, or positions that do not determine the
            parameters.
        UsageError: logs of different rates, or attitudes that do not match the positions.
    """
    base = None if p.into is None else ImuErrorModel.read(p.into)
    logs, before = before_logging(logs, undo=p.as_measured)
    p = replace(p, raw=unit_of_counts(logs, p.raw))
    stretches, notes = still_positions(logs, p.shortest, p.FEWEST, p.raw)
    gravity = _gravity(p)
    check_clipping(stretches, "accel")
    accel = calibration.means([s.accel for s in stretches if s.accel is not None])
    free = isinstance(p, MultiPosition) and p.attitudes is None
    if not free:
        check_still(stretches, accel.value, accel.variance)
    full_range = None
    if isinstance(p, MultiPosition) and p.attitudes:
        given = None if p.range is None else p.range * STANDARD_GRAVITY
        full_range = given or full_range_of("accel", base, [r * STANDARD_GRAVITY for r in RANGES], gravity[0])
    try:
        fit, faces = _fit(p, stretches, accel, gravity[0], full_range)
    except ValueError as error:
        raise MissingDataError(f"{p.METHOD}: {error}") from error
    if free:  # a sway moves gravity across the mean direction, which does not matter here
        check_still(stretches, accel.value, fit.sigma**2)
    axes = {f"accel_{k}": axis for k, axis in zip("xyz", fit.axes, strict=True)}
    check_gain(axes, p.raw)
    gyros = calibrated_gyros(logs, stretches, fit, gravity[0], p)
    axes |= gyros.axes
    celsius, warm_notes = temperature_of(stretches)
    name = logs[0].imu().name
    origin = provenance_of(f"{p.METHOD}, gravity {gravity[0]:.6f} m/s² ({gravity[1]})", logs, p.raw)
    model, model_notes = completed_model(name, axes, base, origin, {"accel": full_range}, celsius)
    notes = [
        *before, *position_notes(p, gravity, fit, full_range), *notes, *gyros.notes, *red_notes("accel", accel), *warm_notes, *model_notes,
    ]  # fmt: skip
    printed = calibration.as_printed(accel, faces, gravity[0], p.level, fit) if faces else ()
    return PositionResult(
        name, p.level, *gravity, p.raw, {axis: parameters_of(axis, c, p.raw) for axis, c in axes.items()},
        {f"accel_{k}": _with_units(x, p.raw) for k, x in zip("xyz", printed, strict=False)}, fit.misplacement, fit.probability,
        _positions(stretches, faces, fit, accel, gyros.means, gyros.residual), celsius, tuple(notes), model,
        tuple(position_traces(stretches, fit.force, model, with_gyro=gyros.means is not None)), gyros.moved,
    )  # fmt: skip


def _gravity(p: SixPosition | MultiPosition) -> tuple[float, str]:
    """Return gravity, m/s², and where it comes from."""
    if p.gravity is not None:
        return p.gravity, "given"
    if p.latitude is not None:
        g = float(normal_gravity(np.array([np.radians(p.latitude)]), np.array([p.height]))[0])
        return g, f"of the ellipsoid at {p.latitude:g}° and {p.height:g} m"
    return STANDARD_GRAVITY, "standard gravity, because neither --latitude nor --gravity is given"


def _fit(
    p: SixPosition | MultiPosition,
    stretches: Sequence[SteadyStretch],
    accel: Means,
    gravity: float,
    full_range: float | None,
) -> tuple[PositionCalibration, tuple[tuple[int, int], ...]]:
    """Return the fit of the accelerometers, and the face of each position of six-position."""
    tilt = None if p.misplacement is None else float(np.radians(p.misplacement))
    if isinstance(p, SixPosition):
        names = [s.name for s in stretches]
        return calibration.six_position(accel, names, gravity, p.level, raw=bool(p.raw), misplacement=tilt)
    if p.attitudes is None:
        samples = [s.accel for s in stretches if s.accel is not None]
        return calibration.without_attitudes(accel, gravity, p.level, raw=bool(p.raw), samples=samples), ()
    force = gravity * _directions_of_up(p.attitudes, len(stretches))
    fit = calibration.known_attitudes(accel, force, p.level, full_range=full_range, misplacement=tilt)
    _check_attitudes(p.attitudes, accel, fit)
    return fit, ()


def _directions_of_up(path: Path, count: int) -> Floats:
    """Return the direction of up in each position, (P, 3), from a file of attitudes."""
    try:
        with path.open(newline="", encoding="utf-8") as file:
            rows = [row for row in csv.reader(file) if any(cell.strip() for cell in row)]
        names = [cell.strip() for cell in rows[0]]
        at = [names.index(name) for name in ("roll_deg", "pitch_deg")]
        roll, pitch = np.radians(np.array([[float(row[k]) for k in at] for row in rows[1:]]).reshape(-1, 2)).T
    except (OSError, UnicodeDecodeError, ValueError, IndexError) as error:
        raise UsageError(
            f"--attitudes {path}: it must be CSV with columns roll_deg and pitch_deg, a number in each row: {error}"
        ) from error
    if roll.size != count or not np.isfinite(roll).all() or not np.isfinite(pitch).all():
        raise UsageError(
            f"--attitudes {path}: {roll.size} attitudes for {count} still positions; there must be one for each, in order"
        )
    return np.stack([np.sin(pitch), -np.sin(roll) * np.cos(pitch), -np.cos(roll) * np.cos(pitch)], axis=1)


def _check_attitudes(path: Path, accel: Means, fit: PositionCalibration) -> None:
    """Raise UsageError if the means contradict the attitudes, for example of another order or of another frame."""
    left = float(np.linalg.norm(fit.residual) / np.linalg.norm(accel.value - accel.value.mean(axis=0)))
    inverted = [
        k for k, axis in zip("xyz", fit.axes, strict=True) if axis.scale_factor and axis.scale_factor.value < -1
    ]
    if left > STRANGE or inverted:
        why = (
            f"accel {', '.join(inverted)} shows the opposite sign"
            if inverted
            else f"{100 * left:.0f} % of the variation of the means is not explained"
        )
        raise UsageError(
            f"--attitudes {path}: the positions do not have these attitudes ({why}); the file must have one row for each "
            "position, in order, with roll and pitch of the forward-right-down frame: 0, 0 is level, z down"
        )


def _positions(
    stretches: Sequence[SteadyStretch],
    faces: Sequence[tuple[int, int]],
    fit: PositionCalibration,
    accel: Means,
    gyro: Means | None,
    gyro_residual: Floats | None,
) -> tuple[Position, ...]:
    def by_axis(i: int, accel_values: Floats, gyro_values: Floats | None) -> dict[str, float]:
        values = {f"accel_{k}": float(v) for k, v in zip("xyz", accel_values[i], strict=True)}
        if gyro_values is not None:
            values |= {f"gyro_{k}": float(v) for k, v in zip("xyz", gyro_values[i], strict=True)}
        return values

    gyro_mean, gyro_sigma = (None, None) if gyro is None else (gyro.value, np.sqrt(gyro.variance))
    return tuple(
        Position(
            s.name, s.seconds, calibration.face_name(faces[i]) if faces else None, by_axis(i, accel.value, gyro_mean),
            (float(fit.force[i, 0]), float(fit.force[i, 1]), float(fit.force[i, 2])),
            by_axis(i, fit.residual, gyro_residual), by_axis(i, fit.sigma, gyro_sigma),
        )
        for i, s in enumerate(stretches)
    )  # fmt: skip


def _with_units(x: PrintedCalibration, raw: str) -> PrintedCalibration:
    return type(x)(x.up, x.down, x.bias.scaled(1.0, raw or "m/s²"), x.scale_factor.scaled(1.0, "1"))

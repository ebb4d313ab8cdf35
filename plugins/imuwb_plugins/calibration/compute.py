"""From still positions to parameters."""

from __future__ import annotations

import csv
from typing import TYPE_CHECKING

import numpy as np

from imuwb.errors import MissingDataError, UsageError
from imuwb.geodesy.earth import gravity as normal_gravity
from imuwb.identification import calibration
from imuwb.log import source_of
from imuwb.units import STANDARD_GRAVITY
from imuwb_plugins.calibration import model as models
from imuwb_plugins.calibration.result import Position, PositionResult, Printed
from imuwb_plugins.calibration.stretches import Stretch, check_clipping, check_still, still, temperature_of
from imuwb_plugins.calibration.traces import position_traces

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from imuwb.identification.calibration import AxisCalibration, Means, PositionCalibration, PrintedCalibration
    from imuwb.log import Floats, Log
    from imuwb.stochastic import ImuErrorModel
    from imuwb_plugins.calibration.parameters import MultiPosition, Positions, SixPosition

RANGES = (2, 4, 8, 16, 32, 64, 128)  #: g, usual ones
UNLIKELY = 0.01
STRANGE = 0.2  #: of what positions show, left over by the fit: they stand elsewhere


def six_position(logs: Sequence[Log], p: SixPosition) -> PositionResult:
    """Return what the six faces of a cube tell."""
    base = models.read_base(p.into)
    found, notes = still(logs, p.shortest)
    gravity, origin = _gravity(p)
    accel = _means(found)
    names = [s.name for s in found]
    tilt = None if p.misplacement is None else float(np.radians(p.misplacement))
    try:
        fit, standing = calibration.six_position(accel, names, gravity, p.level, raw=bool(p.raw), misplacement=tilt)
    except ValueError as error:
        message = f"six-position: {error}"
        raise MissingDataError(message) from error
    printed = calibration.as_printed(accel, standing, gravity, p.level)
    notes += [
        "the non-linear part cannot be parted from the scale factor by one gravity up and down: the scale factor holds it"
    ]
    return _result(logs, p, base, found, accel, fit, (gravity, origin), notes, printed=printed, standing=standing)


def multi_position(logs: Sequence[Log], p: MultiPosition) -> PositionResult:
    """Return what positions of known or unknown attitudes tell."""
    base = models.read_base(p.into)
    found, notes = still(logs, p.shortest)
    gravity, origin = _gravity(p)
    accel = _means(found)
    full_range = None
    try:
        if p.attitudes is None:
            fit = calibration.without_attitudes(accel, gravity, p.level, raw=bool(p.raw))
            notes.append(
                "attitudes are not known: the x axis is the x accelerometer's and y lies in the plane of x and y, so the cross-couplings "
                "y and z into x, and z into y, are 0 by definition"
            )
            notes.append(
                "the non-linear part is left out: a scale factor holds about three quarters of what it makes of one gravity"
            )
        else:
            force = gravity * _ups(p.attitudes, len(found))
            full_range = _full_range(p.range, base, gravity)
            tilt = None if p.misplacement is None else float(np.radians(p.misplacement))
            fit = calibration.known_attitudes(accel, force, p.level, full_range=full_range, misplacement=tilt)
            _check_attitudes(p.attitudes, accel, fit)
            if fit.axes[0].scale_factor_nonlinear is None:
                notes.append(
                    "these positions do not part the non-linear scale factor from the linear one: it is left out"
                )
            else:
                notes.append(f"the non-linear part is told for a full range of {full_range / STANDARD_GRAVITY:g} g")
    except ValueError as error:
        message = f"multi-position: {error}"
        raise MissingDataError(message) from error
    return _result(logs, p, base, found, accel, fit, (gravity, origin), notes, full_range=full_range)


def _gravity(p: Positions) -> tuple[float, str]:
    if p.gravity is not None:
        return p.gravity, "given"
    if p.latitude is not None:
        g = float(normal_gravity(np.array([np.radians(p.latitude)]), np.array([p.height]))[0])
        return g, f"of the ellipsoid at {p.latitude:g}° and {p.height:g} m"
    return STANDARD_GRAVITY, "standard gravity, as neither --latitude nor --gravity is given"


def _means(found: Sequence[Stretch]) -> Means:
    check_clipping(found, "accel")
    means = calibration.means([s.accel for s in found if s.accel is not None])
    check_still(found, means.value, means.variance)
    return means


def _ups(path: Path, count: int) -> Floats:
    """Return the direction of up in each position, (P, 3), from a file of attitudes."""
    try:
        with path.open(newline="", encoding="utf-8") as file:
            rows = [row for row in csv.reader(file) if any(cell.strip() for cell in row)]
        names = [cell.strip() for cell in rows[0]]
        at = [names.index(name) for name in ("roll_deg", "pitch_deg")]
        roll, pitch = np.radians(np.array([[float(row[k]) for k in at] for row in rows[1:]]).reshape(-1, 2)).T
    except (OSError, UnicodeDecodeError, ValueError, IndexError) as error:
        message = (
            f"--attitudes {path}: it must be CSV with columns roll_deg and pitch_deg, a number in each row: {error}"
        )
        raise UsageError(message) from error
    if roll.size != count or not np.isfinite(roll).all() or not np.isfinite(pitch).all():
        message = f"--attitudes {path}: {roll.size} attitudes for {count} still positions; it must have one for each, in order"
        raise UsageError(message)
    return np.stack([np.sin(pitch), -np.sin(roll) * np.cos(pitch), -np.cos(roll) * np.cos(pitch)], axis=1)


def _check_attitudes(path: Path, accel: Means, fit: PositionCalibration) -> None:
    """Raise UsageError where the means do not go with the attitudes, as those of another order, or of another frame."""
    left = float(np.linalg.norm(fit.residual) / np.linalg.norm(accel.value - accel.value.mean(axis=0)))
    turned = [k for k, axis in zip("xyz", fit.axes, strict=True) if axis.scale_factor and axis.scale_factor.value < -1]
    if left > STRANGE or turned:
        message = (
            f"--attitudes {path}: the positions do not stand as it says"
            + (
                f" (accel {', '.join(turned)} would show the opposite)"
                if turned
                else f" ({100 * left:.0f} % of what they show is left over)"
            )
            + "; it must have a row for each position, in their order, of roll and pitch forward-right-down: 0, 0 is level, z down"
        )
        raise UsageError(message)


def _full_range(given: float | None, base: ImuErrorModel | None, gravity: float) -> float:
    if given is not None:
        return given * STANDARD_GRAVITY
    ranges = [axis.range for name, axis in base.axes.items() if name.startswith("accel") and axis.range] if base else []
    return max(ranges) if ranges else next(r for r in RANGES if r * STANDARD_GRAVITY >= gravity) * STANDARD_GRAVITY


def _result(
    logs: Sequence[Log],
    p: Positions,
    base: ImuErrorModel | None,
    found: Sequence[Stretch],
    accel: Means,
    fit: PositionCalibration,
    gravity: tuple[float, str],
    notes: list[str],
    *,
    printed: Sequence[PrintedCalibration] = (),
    standing: Sequence[tuple[int, int]] = (),
    full_range: float | None = None,
) -> PositionResult:
    axes: dict[str, AxisCalibration] = {f"accel_{k}": c for k, c in zip("xyz", fit.axes, strict=True)}
    models.check_gain(axes, p.raw)
    gyro, gyro_residual = _gyros(found, fit, gravity[0], p, axes, notes)
    celsius, warm = temperature_of(found)
    name = logs[0].imu().name
    model, moved = models.made(name, axes, base, _provenance(logs, p, gravity), {"accel": full_range}, celsius)
    red = [_red("accel", accel)] if any(accel.red) else []
    notes = [*_remarks(p, gravity, fit), *notes, *red, *warm, *moved]
    rows = tuple(
        Position(
            s.name, s.seconds, calibration.face_name(standing[i]) if standing else None,
            _by_axis("accel", accel.value[i]) | ({} if gyro is None else _by_axis("gyro", gyro.value[i])),
            (float(fit.force[i, 0]), float(fit.force[i, 1]), float(fit.force[i, 2])),
            _by_axis("accel", fit.residual[i]) | ({} if gyro_residual is None else _by_axis("gyro", gyro_residual[i])),
            _by_axis("accel", fit.sigma[i]) | ({} if gyro is None else _by_axis("gyro", np.sqrt(gyro.variance[i]))),
        )
        for i, s in enumerate(found)
    )  # fmt: skip
    return PositionResult(
        name, p.level, gravity[0], gravity[1], p.raw, {axis: models.parameters(axis, c, p.raw) for axis, c in axes.items()},
        {f"accel_{k}": _printed(x, p.raw) for k, x in zip("xyz", printed, strict=False)}, fit.misplacement, fit.probability, rows,
        celsius, tuple(notes), model, tuple(position_traces(found, fit.force, model, with_gyro=gyro is not None)),
    )  # fmt: skip


def _gyros(
    found: Sequence[Stretch],
    fit: PositionCalibration,
    gravity: float,
    p: Positions,
    axes: dict[str, AxisCalibration],
    notes: list[str],
) -> tuple[Means | None, Floats | None]:
    """Add the gyros' parameters to ``axes``; return their means and residuals."""
    if found[0].gyro is None:
        return None, None
    check_clipping(found, "gyro")
    means = calibration.means([s.gyro for s in found if s.gyro is not None])
    stuck = np.ptp(np.concatenate([s.gyro for s in found if s.gyro is not None]), axis=0) == 0
    if stuck.any():
        notes.append(
            f"gyro {', '.join(k for k, s in zip('xyz', stuck, strict=True) if s)} is constant: gyros are left out"
        )
        return None, None
    latitude = None if p.latitude is None else float(np.radians(p.latitude))
    gyros, residual = calibration.static_gyros(means, fit.force, gravity, p.level, latitude)
    axes |= {f"gyro_{k}": c for k, c in zip("xyz", gyros, strict=True)}
    notes.append(
        "gyros: still positions tell bias and g-sensitivity; scale factors and cross-couplings need a rate table"
        + (
            "; the earth's rate (0.0042 deg/s) is not taken off without --latitude, and is in the intervals"
            if latitude is None
            else ""
        )
    )
    if any(means.red):
        notes.append(_red("gyro", means))
    return means, residual


def _red(sensor: str, means: Means) -> str:
    axes = ", ".join(k for k, red in zip("xyz", means.red, strict=True) if red)
    return (
        f"{sensor} {axes}: noise within positions is not white; means count no more than those of a quarter of a position, and the "
        "bias is that of the time of the positions: it drifts on"
    )


def _remarks(p: Positions, gravity: tuple[float, str], fit: PositionCalibration) -> list[str]:
    said = [f"gravity {gravity[0]:.6f} m/s² ({gravity[1]})"]
    if p.latitude is None and p.gravity is None:
        said[0] += "; on earth it differs by up to 0.3 %, and all three scale factors would be wrong by as much"
    elif p.gravity is None:
        said[0] += (
            "; an anomaly of the place (50 mGal are 0.005 %) enters all three scale factors alike, and no position shows it"
        )
    if fit.misplacement is not None:
        said.append(
            f"positions stand {np.degrees(fit.misplacement):.3g}° rms off; cross-couplings' intervals know of it"
        )
    if fit.misplacement is None and fit.freedom and fit.probability < UNLIKELY:
        said.append(
            f"residuals are larger than noise makes them (probability {fit.probability:.1e}): the intervals allow for it"
        )
    told = getattr(p, "misplacement", None)
    chance = "below 1e-6" if fit.probability < 1e-6 else f"{fit.probability:.1e}"  # noqa: PLR2004 - as good as none
    if told is not None and fit.freedom and fit.probability < UNLIKELY:
        said.append(
            f"residuals are larger than noise and --misplacement {told:g} make them (probability {chance}): "
            "the intervals are too narrow; without --misplacement the residuals tell"
        )
    if fit.misplacement is None and not fit.freedom:
        said.append("as many parameters as positions: nothing is left over to judge the fit by; more positions would")
    return said


def _provenance(logs: Sequence[Log], p: Positions, gravity: tuple[float, str]) -> dict[str, str]:
    method = type(p).__name__.replace("Position", "-position").lower()
    return {
        "calibration": f"{method}, gravity {gravity[0]:.6f} m/s² ({gravity[1]})"
        + (f", {p.raw} to SI" if p.raw else ""),
        "calibration_logs": "; ".join(source_of(log) for log in logs),
    }


def _by_axis(sensor: str, values: Floats) -> dict[str, float]:
    return {f"{sensor}_{k}": float(v) for k, v in zip("xyz", values, strict=True)}


def _printed(x: PrintedCalibration, raw: str) -> Printed:
    return Printed(x.up, x.down, models.parameter(x.bias, raw or "m/s²"), models.parameter(x.scale_factor, "1"))

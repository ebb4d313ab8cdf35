"""From a log's fixes and speeds to the events that correct a filter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from imuwb.errors import MissingDataError
from imuwb.log import SECOND
from imuwb.navigation.tables import FIX, SPEED, STILL, STRAIGHT, Events

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from imuwb.log import Floats, GnssStream, Log
    from imuwb.navigation.filter_model import FilterModel
    from imuwb.navigation.measurement import Measurement

FEW = 5  #: fixes
LEAST_FIX = 3  #: fix type: three dimensions
IMPOSSIBLE = 350.0  #: m/s: no receiver's velocity
EACH = 1.0  #: s between two events of an aid
LEAST_SIGMA = (0.005, 0.005)  #: m and m/s; what a receiver claims below is not believed


@dataclass(frozen=True, eq=False, slots=True)
class Corrections:
    """The events of a log, and which of its fixes they are."""

    events: Events
    time: Floats  #: (E,) s from the log's start
    fix: NDArray[np.int64]  #: (E,) row of the receiver's stream; below 0 where the event is no fix's position
    notes: tuple[str, ...] = ()


def corrections(log: Log, gnss: GnssStream, moves: Measurement, still: Floats, model: FilterModel) -> Corrections:
    """Return what corrects a filter, in order of time.

    Fixes without a position in three dimensions and held duplicates are left out; velocities that cannot be are not used.

    Args:
        log: what the receiver belongs to: its zero counts, its first speed is the odometer.
        gnss: the receiver.
        moves: the IMU.
        still: (s, 2) s from the log's start: when the IMU stands still.
        model: delays, default sigmas and aids.

    Raises:
        MissingDataError: too few fixes within the IMU's time.
    """
    notes: list[str] = []
    zero = log.zero or 0
    own = (gnss.time - zero) / SECOND - model.installation.gnss_delay
    good = _usable(gnss, notes)
    inside = good & (own > moves.time[0]) & (own < moves.time[-1])
    if inside.sum() < FEW:
        message = (
            f"{log.provenance.path}: {int(inside.sum())} usable fixes of {gnss.name} lie within the IMU's time "
            f"({moves.time[0]:.1f} s to {moves.time[-1]:.1f} s; the fixes: {own[0]:.1f} s to {own[-1]:.1f} s); "
            f"a filter needs {FEW}"
        )
        raise MissingDataError(message)
    rows = np.flatnonzero(inside)
    parts = _fixes(gnss, rows, own, moves, model, notes)
    if model.aids.speed and log.speeds:
        stream = log.speeds[0]
        parts.append(_speeds((stream.time - zero) / SECOND, stream.value, moves, model.aids.speed))
    grid = np.arange(np.ceil(moves.time[0]), moves.time[-1], EACH)
    if model.aids.straight:
        parts.append(_aid(STRAIGHT, grid, moves, (model.aids.straight,) * 2))
    if model.aids.still:
        standing = np.zeros(grid.size, dtype=bool)
        for begin, end in still:
            standing |= (grid > begin) & (grid < end)
        parts.append(_aid(STILL, grid[standing], moves, (model.aids.still,) * 3))
    joined = [np.concatenate([part[i] for part in parts]) for i in range(7)]
    order = np.lexsort((joined[1], joined[0]))
    at, kind, late, value, variance, time, fix = (array[order] for array in joined)
    return Corrections(Events(at, kind, late, value, variance), time, fix, tuple(notes))


def _usable(gnss: GnssStream, notes: list[str]) -> NDArray[np.bool_]:
    good = np.isfinite(gnss.position).all(axis=1) & (np.abs(gnss.position[:, 0]) < 0.4999 * np.pi)
    if gnss.fix_type is not None:
        flat = gnss.fix_type < LEAST_FIX
        if flat.any():
            notes.append(f"{gnss.name}: {int(flat.sum())} fixes of less than three dimensions are not used")
        good &= ~flat
    held = np.zeros(len(gnss), dtype=bool)
    if len(gnss) > 1:
        held[1:] = (np.diff(gnss.position, axis=0) == 0).all(axis=1)
        if gnss.velocity is not None:
            held[1:] &= (np.diff(gnss.velocity, axis=0) == 0).all(axis=1)
            moving = np.nan_to_num(np.abs(gnss.velocity)).max(axis=1) > 1
            held &= moving
        else:
            held[:] = False  # who stands still repeats himself
    if (held & good).any():
        notes.append(
            f"{gnss.name}: {int((held & good).sum())} fixes that repeat the one before while moving are not used"
        )
    return good & ~held


def _fixes(
    gnss: GnssStream, rows: NDArray[np.int64], own: Floats, moves: Measurement, model: FilterModel, notes: list[str]
) -> list[tuple[NDArray[Any], ...]]:
    settings = model.settings
    value, sigma = np.zeros((rows.size, 6)), np.zeros((rows.size, 6))
    value[:, :3] = gnss.position[rows]
    sigma[:, :3] = _sigmas(gnss.position_sigma, rows, settings.position_sigma, settings.sigma_scale, LEAST_SIGMA[0])
    if gnss.position_sigma is None:
        notes.append(f"{gnss.name} claims no sigmas of position: {settings.position_sigma} m are taken")
    if gnss.velocity is None:
        notes.append(f"{gnss.name} has no velocity: positions alone correct the filter")
    else:
        value[:, 3:] = np.nan_to_num(gnss.velocity[rows])
        sigma[:, 3:] = _sigmas(gnss.velocity_sigma, rows, settings.velocity_sigma, settings.sigma_scale, LEAST_SIGMA[1])
        sigma[:, 3:][~np.isfinite(gnss.velocity[rows])] = 0.0
        wild = (np.abs(value[:, 3:]) > IMPOSSIBLE).any(axis=1)
        if wild.any():
            notes.append(f"{gnss.name}: {int(wild.sum())} velocities above {IMPOSSIBLE:g} m/s are not used")
        sigma[wild, 3:] = value[wild, 3:] = 0.0
        if gnss.velocity_sigma is None:
            notes.append(f"{gnss.name} claims no sigmas of velocity: {settings.velocity_sigma} m/s are taken")
    variance = sigma**2
    if not model.installation.velocity_delay:
        at, late = _placed(own[rows], moves)
        return [(at, np.full(rows.size, FIX), late, value, variance, own[rows], rows)]
    # Position and velocity are of different times: an event each, both gone in an outage.
    parts: list[tuple[NDArray[Any], ...]] = []
    for columns, delay, names in ((slice(3), 0.0, rows), (slice(3, 6), model.installation.velocity_delay, -1 - rows)):
        time = own[rows] - delay
        some = np.zeros_like(variance)
        some[:, columns] = variance[:, columns]
        inside = time > moves.time[0]
        at, late = _placed(time[inside], moves)
        parts.append((at, np.full(at.size, FIX), late, value[inside], some[inside], time[inside], names[inside]))
    return parts


def _sigmas(
    claimed: Floats | None, rows: NDArray[np.int64], default: tuple[float, float], scale: float, least: float
) -> Floats:
    known = np.tile([default[0], default[0], default[1]], (rows.size, 1))
    if claimed is not None:
        told = claimed[rows] * scale
        known = np.where(np.isfinite(told) & (told > 0), np.maximum(told, least), known)
    return known


def _speeds(time: Floats, speed: Floats, moves: Measurement, sigma: float) -> tuple[NDArray[Any], ...]:
    inside = np.flatnonzero((time > moves.time[0]) & (time < moves.time[-1]))
    # One a second: an odometer's errors hold on longer than its samples.
    inside = inside[np.unique(np.floor(time[inside] / EACH), return_index=True)[1]]
    at, late = _placed(time[inside], moves)
    value, variance = np.zeros((2, inside.size, 6))
    value[:, 0], variance[:, 0] = speed[inside], sigma**2
    return at, np.full(inside.size, SPEED), late, value, variance, time[inside], np.full(inside.size, -1)


def _aid(kind: int, time: Floats, moves: Measurement, sigma: tuple[float, ...]) -> tuple[NDArray[Any], ...]:
    at, late = _placed(time, moves)
    value, variance = np.zeros((2, time.size, 6))
    variance[:, : len(sigma)] = np.square(sigma)
    return at, np.full(time.size, kind), late, value, variance, time, np.full(time.size, -1)


def _placed(time: Floats, moves: Measurement) -> tuple[NDArray[np.int64], Floats]:
    """Return the sample whose end is nearest, and how much later the time is."""
    behind = np.clip(np.searchsorted(moves.time, time), 1, moves.time.size - 1)
    nearer = behind - (time - moves.time[behind - 1] < moves.time[behind] - time)
    return nearer.astype(np.int64), time - moves.time[nearer]

"""The events that correct a filter, in order of time: fixes, speeds, and constraints on the vehicle's motion."""

from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from imuwb.arrays import Booleans, Floats, Integers
from imuwb.errors import MissingDataError
from imuwb.log import SECOND, GnssStream, Log
from imuwb.navigation.filter_model import FilterModel, Settings, receiver_variance
from imuwb.navigation.measurement import Measurement
from imuwb.navigation.tables import FIX, SPEED, STILL, STRAIGHT, Events
from imuwb.notes import Note

FEW = 5  #: fewest fixes that a filter needs
LEAST_FIX = 3  #: fix type of a position in three dimensions
IMPOSSIBLE = 350.0  #: m/s; a larger velocity is an error of the receiver
SLOWER = 0.99  #: IMU intervals; at a shorter interval between fixes, several fixes fall on one sample
MOVING = 1.0  #: m/s; a faster receiver does not report the same position twice
EACH = 1.0  #: s between two events of an aid
JITTER = (
    0.25  #: usual intervals between fixes; a fix that is early by this much is still far enough from the fix before
)
LEAST_WHITE = 0.01  #: of a position's stated variance, which is white at least, whatever its correlated error
LEAST_SIGMA = (0.005, 0.005)  #: m and m/s; smaller sigmas of a receiver are raised to this


@dataclass(frozen=True, eq=False, slots=True)
class Corrections:
    """The events of a log, and the fix that each event comes from."""

    events: Events
    time: Floats  #: (E,) s from the log's start
    fix: Integers  #: (E,) row in the receiver's stream; -1 - row for a fix's separate velocity; -1 for other kinds
    notes: tuple[Note, ...] = ()

    def __repr__(self) -> str:
        """Return the numbers of events in a line."""
        kinds = np.bincount(self.events.kind, minlength=4)
        return (
            f"Corrections: {kinds[FIX]} of fixes, {kinds[SPEED]} of speed, {kinds[STRAIGHT]} of no slip, "
            f"{kinds[STILL]} of standing still"
        )


class _Part(NamedTuple):
    """Events of one kind."""

    at: Integers
    kind: Integers
    late: Floats
    value: Floats
    variance: Floats
    time: Floats
    fix: Integers


def corrections_of(
    log: Log, gnss: GnssStream, measurement: Measurement, stills: Floats, model: FilterModel
) -> Corrections:
    """Return the events that correct a filter, in order of time.

    Fixes without a position in three dimensions, and repeated fixes in motion, are not used; nor are impossible velocities.

    Args:
        log: the log of the receiver; times count from its start, and its first stream of speeds is the odometer.
        gnss: the receiver.
        measurement: the IMU.
        stills: (s, 2) s from the log's start, the standstills.
        model: delays, default sigmas and aids.

    Raises:
        MissingDataError: too few fixes within the IMU's time.
    """
    notes: list[Note] = []
    zero, aids = log.zero or 0, model.aids
    time = (gnss.time - zero) / SECOND - model.installation.gnss_delay
    rows = _usable_rows(log, gnss, time, measurement, model.settings.spacing, notes)
    parts = _fixes(gnss, rows, time, measurement, model, notes)
    if aids.speed and log.speeds:
        stream = log.speeds[0]
        parts.append(_speeds((stream.time - zero) / SECOND, stream.value, measurement, aids.speed))
    grid = np.arange(np.ceil(measurement.time[0]), measurement.time[-1], EACH)
    if aids.straight:
        parts.append(_aid(STRAIGHT, grid, measurement, (aids.straight,) * 2))
    if aids.still:
        standing = np.zeros(grid.size, dtype=bool)
        for begin, end in stills:
            standing |= (grid > begin) & (grid < end)
        parts.append(_aid(STILL, grid[standing], measurement, (aids.still,) * 3))
    columns: list[NDArray[Any]] = [np.concatenate(arrays) for arrays in zip(*parts, strict=True)]
    order = np.lexsort((columns[1], columns[0]))
    at, kind, late, value, variance, time, fix = (column[order] for column in columns)
    return Corrections(Events(at, kind, late, value, variance), time, fix, tuple(notes))


def floor_variance(floor: tuple[float, float]) -> Floats:
    """Return the variances that a floor of sigmas adds to a fix, (6,) m² and (m/s)², NED.

    Args:
        floor: m and m/s, of positions and velocities; a height's is twice as large.
    """
    p, v = floor
    return np.square([p, p, 2 * p, v, v, v])


def raised(corrections: Corrections, floor: tuple[float, float]) -> Corrections:
    """Return corrections whose fixes have larger variances: a floor's are added to what is measured."""
    events = corrections.events
    added = np.where((events.kind == FIX)[:, None] & (events.variance > 0), floor_variance(floor), 0.0)
    return replace(corrections, events=events._replace(variance=events.variance + added))


def uncorrelated(corrections: Corrections, sigma: float) -> tuple[Corrections, Floats]:
    """Return corrections without the part of their positions' variances that a correlated error explains.

    A receiver states the sigma of its whole error. With states for the correlated part, only the rest is white: what it states
    minus the variance of the correlated part, but at least ``LEAST_WHITE`` of what it states.

    Args:
        corrections: the corrections.
        sigma: m, horizontal, of the correlated error.

    Returns:
        The corrections, and by how much the variance of white and correlated errors exceeds what each event states, (E, 3) m².
    """
    events = corrections.events
    part, stated = receiver_variance(sigma), events.variance[:, :3]
    known = (events.kind == FIX)[:, None] & (stated > 0)
    white = np.where(known, np.maximum(stated - part, LEAST_WHITE * stated), stated)
    variance = np.column_stack([white, events.variance[:, 3:]])
    return replace(corrections, events=events._replace(variance=variance)), white + part - stated


def _usable_rows(
    log: Log, gnss: GnssStream, time: Floats, measurement: Measurement, spacing: float, notes: list[Note]
) -> Integers:
    """Return the rows of the fixes that can be used and lie within the IMU's time."""
    own = measurement.time
    # The choice does not depend on a delay, so that filters with different delays use the same fixes.
    rows = _spaced(np.flatnonzero(_usable(gnss, notes)), time, spacing, notes)
    rows = rows[(time[rows] > own[0]) & (time[rows] < own[-1])]
    if rows.size < FEW:
        apart = time[0] > own[-1] or time[-1] < own[0]
        remedy = (
            f"; if the clocks differ, --gnss-shift {own[0] - time[0]:.1f} lets both begin together" if apart else ""
        )
        raise MissingDataError(
            f"{log.provenance.path}: {rows.size} usable fixes of {gnss.name} lie within the IMU's time "
            f"({own[0]:.1f} s to {own[-1]:.1f} s; the fixes: {time[0]:.1f} s to {time[-1]:.1f} s); a filter needs {FEW}{remedy}"
        )
    usual = float(np.median(np.diff(time[rows])))
    if usual < SLOWER * measurement.interval:
        text = (
            f"the IMU has {1 / measurement.interval:.3g} samples a second, fewer than {gnss.name} has fixes ({1 / usual:.3g} a second): "
            "several fixes correct the filter after one sample, and motion between the samples is not seen"
        )
        notes.append(Note("slow-imu", text))
    return rows


def _spaced(rows: Integers, time: Floats, spacing: float, notes: list[Note]) -> Integers:
    """Return the rows of fixes at least ``spacing`` apart."""
    if not spacing or rows.size < 2:  # noqa: PLR2004 - one fix has no neighbour
        return rows
    # Fixes of a regular receiver stay regular: the step is a whole number of its intervals, with room for jitter.
    least = spacing - JITTER * float(np.median(np.diff(time[rows])))
    kept = [int(rows[0])]
    for row in rows[1:]:
        if time[row] - time[kept[-1]] >= least:
            kept.append(int(row))
    if len(kept) < rows.size:
        text = (
            f"{len(kept)} of {rows.size} fixes are used, at least {spacing:g} s apart: the errors of neighbours are not "
            "independent"
        )
        notes.append(Note("spaced-fixes", text))
    return np.array(kept)


def _usable(gnss: GnssStream, notes: list[Note]) -> Booleans:
    good = np.isfinite(gnss.position).all(axis=1) & (np.abs(gnss.position[:, 0]) < 0.4999 * np.pi)
    if gnss.fix_type is not None:
        flat = gnss.fix_type < LEAST_FIX
        if flat.any():
            text = f"{gnss.name}: {int(flat.sum())} fixes without a position in three dimensions are not used"
            notes.append(Note("flat-fixes", text))
        good &= ~flat
    repeated = _repeated(gnss)
    if (repeated & good).any():
        text = f"{gnss.name}: {int((repeated & good).sum())} fixes repeat the previous fix although the receiver moves; they are not used"
        notes.append(Note("repeated-fixes", text))
    return good & ~repeated


def _repeated(gnss: GnssStream) -> Booleans:
    """Return which fixes repeat the previous fix in motion; none without velocities: the receiver may stand still."""
    repeated = np.zeros(len(gnss), dtype=bool)
    if len(gnss) > 1 and gnss.velocity is not None:
        repeated[1:] = (np.diff(gnss.position, axis=0) == 0).all(axis=1)
        repeated[1:] &= (np.diff(np.nan_to_num(gnss.velocity), axis=0) == 0).all(axis=1)
        repeated &= np.nan_to_num(np.abs(gnss.velocity)).max(axis=1) > MOVING
    return repeated


def _fixes(
    gnss: GnssStream, rows: Integers, time: Floats, measurement: Measurement, model: FilterModel, notes: list[Note]
) -> list[_Part]:
    """Return the events of fixes: one for each, or two if position and velocity are of different times."""
    value, variance = _values(gnss, rows, model, notes)
    if not model.installation.velocity_delay:
        at, late = _placed(time[rows], measurement)
        return [_Part(at, np.full(rows.size, FIX), late, value, variance, time[rows], rows)]
    parts: list[_Part] = []
    for columns, delay, names in ((slice(3), 0.0, rows), (slice(3, 6), model.installation.velocity_delay, -1 - rows)):
        own = time[rows] - delay
        kept = np.zeros_like(variance)
        kept[:, columns] = variance[:, columns]
        inside = own > measurement.time[0]
        at, late = _placed(own[inside], measurement)
        parts.append(_Part(at, np.full(at.size, FIX), late, value[inside], kept[inside], own[inside], names[inside]))
    return parts


def _values(gnss: GnssStream, rows: Integers, model: FilterModel, notes: list[Note]) -> tuple[Floats, Floats]:
    """Return values and variances of fixes, each (f, 6): position and velocity; a variance of 0: not measured."""
    settings = model.settings
    value, sigma = np.zeros((rows.size, 6)), np.zeros((rows.size, 6))
    value[:, :3] = gnss.position[rows]
    position_sigma, velocity_sigma = _claimed(gnss, settings)
    sigma[:, :3] = _sigmas(position_sigma, rows, settings.position_sigma, settings.sigma_scale[0], LEAST_SIGMA[0])
    if position_sigma is None:
        flat, up = settings.position_sigma
        text = f"{gnss.name} reports no sigmas of positions; the defaults {flat:g} m (horizontal) and {up:g} m (vertical) are used"
        notes.append(Note("default-position-sigmas", text))
    if gnss.velocity is None:
        notes.append(Note("no-velocities", f"{gnss.name} has no velocities: only positions correct the filter"))
        return value, sigma**2
    value[:, 3:] = np.nan_to_num(gnss.velocity[rows])
    sigma[:, 3:] = _sigmas(velocity_sigma, rows, settings.velocity_sigma, settings.sigma_scale[1], LEAST_SIGMA[1])
    known = np.isfinite(gnss.velocity[rows])
    sigma[:, 3:][~known] = 0.0
    lacking = int((known[:, :2].all(axis=1) & ~known[:, 2]).sum())
    if lacking:
        text = f"{gnss.name} reports no velocity down for {lacking} of {rows.size} fixes; their north and east correct the filter"
        notes.append(Note("no-velocity-down", text))
    wild = (np.abs(value[:, 3:]) > IMPOSSIBLE).any(axis=1)
    if wild.any():
        text = f"{gnss.name}: {int(wild.sum())} velocities above {IMPOSSIBLE:g} m/s are not used"
        notes.append(Note("impossible-velocities", text))
    sigma[wild, 3:] = value[wild, 3:] = 0.0
    if velocity_sigma is None:
        flat, up = settings.velocity_sigma
        text = f"{gnss.name} reports no sigmas of velocities; the defaults {flat:g} m/s (horizontal) and {up:g} m/s (vertical) are used"
        notes.append(Note("default-velocity-sigmas", text))
    return value, sigma**2


def _claimed(gnss: GnssStream, settings: Settings) -> tuple[Floats | None, Floats | None]:
    """Return the sigmas of positions and velocities, each (f, 3): stated ones, or the receiver's own; None: unknown."""
    (p, v), shape = settings.sigma_stated, (len(gnss), 1)
    position = np.tile([p, p, 2 * p], shape) if p else gnss.position_sigma
    return position, np.tile([v, v, v], shape) if v else gnss.velocity_sigma


def _sigmas(
    reported: Floats | None, rows: Integers, default: tuple[float, float], scale: float, least: float
) -> Floats:
    sigmas = np.tile([default[0], default[0], default[1]], (rows.size, 1))
    if reported is not None:
        scaled = reported[rows] * scale
        sigmas = np.where(np.isfinite(scaled) & (scaled > 0), np.maximum(scaled, least), sigmas)
    return sigmas


def _speeds(time: Floats, speed: Floats, measurement: Measurement, sigma: float) -> _Part:
    inside = np.flatnonzero((time > measurement.time[0]) & (time < measurement.time[-1]))
    # One speed a second: the errors of an odometer's samples are correlated over a longer time.
    inside = inside[np.unique(np.floor(time[inside] / EACH), return_index=True)[1]]
    part = _aid(SPEED, time[inside], measurement, (sigma,))
    part.value[:, 0] = speed[inside]
    return part


def _aid(kind: int, time: Floats, measurement: Measurement, sigma: tuple[float, ...]) -> _Part:
    at, late = _placed(time, measurement)
    value, variance = np.zeros((2, time.size, 6))
    variance[:, : len(sigma)] = np.square(sigma)
    return _Part(at, np.full(time.size, kind), late, value, variance, time, np.full(time.size, -1))


def _placed(time: Floats, measurement: Measurement) -> tuple[Integers, Floats]:
    """Return, for each time, the sample with the nearest end, and the time minus that end, s."""
    own = measurement.time
    after = np.clip(np.searchsorted(own, time), 1, own.size - 1)
    nearest = after - (time - own[after - 1] < own[after] - time)
    return nearest.astype(np.int64), time - own[nearest]

"""The streams of a u-blox log: one receiver with the best of each message, and its inertial sensors."""

from collections.abc import Iterator

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.errors import UnreadableLogError
from imuwb.log import Nanoseconds, Origin
from imuwb.notes import Note
from imuwb.readers.batch import Batch, Remark, unused
from imuwb.readers.bytes.source import Source
from imuwb.readers.flight import trajectory
from imuwb.readers.read_options import ReadOptions
from imuwb.readers.receivers import nmea_streams
from imuwb.readers.receivers.ubx_clock import MILLI, WEEK_MS, UbxClock, ubx_clock
from imuwb.readers.receivers.ubx_log import UbxLog, Values
from imuwb.readers.receivers.ubx_messages import (
    COVARIANCE,
    HIGH_PRECISION,
    MEASURED,
    POSITION,
    PVT,
    RAW,
    RAW_SIGNALS,
    SOLUTION,
    STATUS,
    VELOCITY,
    name_of,
)
from imuwb.readers.receivers.ubx_sensors import sensor_streams

NAME = "gnss"
INVALID = 1  #: flag: the position is not valid
FIX_OK, DIFFERENTIAL, CARRIER = 1, 2, 6  #: flags: within the limits, corrected; bits before those of the carrier phase
#: fix of NAV-PVT and NAV-STATUS (none, dead reckoning, 2D, 3D, 3D with dead reckoning, time) -> MAVLink's fix type
FIXES = np.array([1, 1, 2, 3, 3, 1])
RECKONED, COMBINED = 1, 4
Columns = dict[str, Floats]


def streamed(path: Source, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the receiver, then its sensors, then notes.

    Raises:
        UnreadableLogError: the file has no whole frame.
    """
    log = UbxLog(path)
    if not log.frames:
        raise UnreadableLogError(f"{path}: no UBX frame has a correct checksum")
    yield from map(Remark, log.notes)
    clock = ubx_clock(log)
    kind = next((kind for kind in (PVT, POSITION, HIGH_PRECISION) if log.rows(kind) is not None), None)
    if kind is not None:
        yield from _receiver(log, kind, clock)
    for sensor in sorted((MEASURED, RAW), key=lambda sensor: -len((log.rows(sensor) or {"tag": ()})["tag"])):
        rows = log.rows(sensor)
        if rows is not None and rows["tag"].size:
            yield from sensor_streams(name_of(sensor), rows, clock, options.frame, log.bytes_read)
    yield from _sentences(log, fixes=kind is not None)
    yield from map(Remark, log.faults())
    if count := log.counts[RAW_SIGNALS]:
        yield unused(
            [f"{name_of(RAW_SIGNALS)} ({count})"], "raw signals, from which RTKLIB computes fixes: give its .pos file"
        )
    if names := log.unused():
        yield unused(names, "UBX messages without a value that imuwb uses")


def _sentences(log: UbxLog, *, fixes: bool) -> Iterator[Batch | Remark]:
    """Yield the fixes of NMEA sentences between the frames, if no frame states positions."""
    sentences = log.sentences
    if not fixes:
        yield from nmea_streams.streamed(sentences, log.bytes_read)
    elif sentences.counts:
        names = [f"{kind.decode()} ({count})" for kind, count in sentences.counts.items()]
        yield unused(names, "NMEA sentences; the UBX messages state the same fixes more finely")
    if fixes:
        yield from nmea_streams.faults(sentences)


def _receiver(log: UbxLog, kind: int, clock: UbxClock | None) -> Iterator[Batch | Remark]:
    """Yield the fixes: those of one message, with what other messages state of the same epochs."""
    rows = log.rows(kind) or {}
    valid = rows["tow"] < WEEK_MS
    if kind == HIGH_PRECISION:
        valid &= (rows["flags"] & INVALID) == 0
    if kind == PVT:
        valid &= (rows["flags3"] & INVALID) == 0
    if lost := int(np.count_nonzero(~valid)):
        yield Remark(Note("invalid_position", "fixes whose position the receiver calls invalid left out"), NAME, lost)
    rows = {name: values[valid] for name, values in rows.items()}
    epochs, time = _times(rows, clock)
    columns = _columns(kind, rows)
    for other, joined in (
        (HIGH_PRECISION, _fine),
        (VELOCITY, _velocity),
        (COVARIANCE, _covariance),
        (SOLUTION, _status),
        (STATUS, _status),
    ):
        more = (
            log.rows(other) if other != kind and not (other in (VELOCITY, SOLUTION, STATUS) and kind == PVT) else None
        )
        if more is not None:
            theirs = _times(more, clock)[0] if clock is not None or other == kind else _unwrapped(more["tow"])
            _joined(columns, epochs, theirs, joined(more))
    yield from trajectory.located(
        NAME,
        "gnss",
        time,
        columns,
        Origin("1e-7 deg, mm, mm/s", "NED", "log" if clock is None else "unix"),
        log.bytes_read,
    )
    yield from map(Remark, _notes(kind, rows, clock))


def _notes(kind: int, rows: Values, clock: UbxClock | None) -> Iterator[Note]:
    if clock is None:
        yield Note("no_date", f"{NAME}: no message states the date; times count from the start of the GPS week")
    elif not clock.resolved:
        yield Note(
            "utc_unresolved", f"{NAME}: the receiver never knew the leap seconds, so its UTC may be off by some seconds"
        )
    if kind != PVT:
        return
    reckoned, combined = (int(np.count_nonzero(rows["fix"] == fix)) for fix in (RECKONED, COMBINED))
    if reckoned:
        yield Note(
            "dead_reckoning",
            f"{NAME}: {reckoned} fixes are dead reckoning of the receiver's own sensors; they count as no fix",
        )
    if combined:
        yield Note(
            "sensor_fusion",
            f"{NAME}: {combined} fixes are combined with the receiver's own inertial sensors, so they are smoothed",
        )


def _times(rows: Values, clock: UbxClock | None) -> tuple[Integers, Nanoseconds]:
    """Return the epochs of messages (ms), by which messages are joined, and their time (ns)."""
    tow = rows["tow"].astype(np.int64)
    if clock is None:
        epochs = _unwrapped(tow)
        return epochs, epochs * MILLI
    epochs = clock.epochs(rows["place"], tow)
    return epochs, clock.unix(rows["place"], epochs)


def _unwrapped(tow: Integers) -> Integers:
    """Return times of week (ms) that go on after the week's end."""
    tow = tow.astype(np.int64)
    weeks = np.cumsum(np.diff(tow, prepend=tow[:1]) < -WEEK_MS // 2)
    return tow + weeks * WEEK_MS


def _columns(kind: int, rows: Values) -> Columns:
    """Return the columns that one message states."""
    if kind == HIGH_PRECISION:
        return _fine(rows)
    position = trajectory.positions(rows["latitude"] * 1e-7, rows["longitude"] * 1e-7, rows["height"] * 1e-3)
    columns = {
        "position": position,
        "position_sigma": trajectory.sigmas(rows["horizontal"] * 1e-3, rows["vertical"] * 1e-3),
    }
    if kind == PVT:
        columns |= {
            "velocity": rows["velocity"] * 1e-3,
            "velocity_sigma": np.repeat(rows["speed_sigma"][:, None] * 1e-3, 3, axis=1),
            "fix_type": fix_types(rows["fix"], rows["flags"], rows["flags"] >> CARRIER & 3),
        }
    return columns


def fix_types(fix: Integers, flags: Integers, carrier: Integers) -> Floats:
    """Return MAVLink's fix types; a fix outside the receiver's limits is none."""
    types = FIXES[np.minimum(fix, FIXES.size - 1)]
    positioned = (types >= 2) & ((flags & FIX_OK) > 0)  # noqa: PLR2004 - 2: a position
    types = np.where(positioned & (types > 2) & ((flags & DIFFERENTIAL) > 0), 4, types)  # noqa: PLR2004
    types = np.where(positioned & (carrier == 1), 5, np.where(positioned & (carrier == 2), 6, types))  # noqa: PLR2004 - float, fixed
    return np.where(positioned, types, 1).astype(np.float64)


def _fine(rows: Values) -> Columns:
    """Return the columns of NAV-HPPOSLLH, in steps of 1e-9 degrees and 0.1 mm."""
    latitude, longitude = ((rows[name] * 100.0 + rows[f"fine_{name}"]) * 1e-9 for name in ("latitude", "longitude"))
    height = (rows["height"] * 10.0 + rows["fine_height"]) * 1e-4
    sigma = trajectory.sigmas(rows["horizontal"] * 1e-4, rows["vertical"] * 1e-4)
    position = trajectory.positions(latitude, longitude, height)
    invalid = ((rows["flags"] & INVALID) > 0)[:, None]
    return {"position": np.where(invalid, np.nan, position), "position_sigma": np.where(invalid, np.nan, sigma)}


def _velocity(rows: Values) -> Columns:
    return {
        "velocity": rows["velocity"] * 1e-2,
        "velocity_sigma": np.repeat(rows["speed_sigma"][:, None] * 1e-2, 3, axis=1),
    }


def _covariance(rows: Values) -> Columns:
    """Return the sigmas of NAV-COV; its six numbers are NN, NE, ND, EE, ED, DD."""
    columns: Columns = {}
    for name in ("position", "velocity"):
        variance = rows[name][:, [0, 3, 5]].astype(np.float64)
        with np.errstate(invalid="ignore"):
            sound = (rows[f"{name}_valid"] == 1)[:, None] & (variance >= 0) & np.isfinite(variance)
        columns[f"{name}_sigma"] = np.sqrt(np.where(sound, variance, np.nan))
    return columns


def _status(rows: Values) -> Columns:
    return {"fix_type": fix_types(rows["fix"], rows["flags"], np.zeros(rows["fix"].size, np.int64))}


def _joined(columns: Columns, epochs: Integers, theirs: Integers, more: Columns) -> None:
    """Put the values of other messages, where they are known, into the rows of the same epochs."""
    _, mine, other = np.intersect1d(epochs, theirs, return_indices=True)
    for name, values in more.items():
        column = columns.get(name, np.full((epochs.size, *values.shape[1:]), np.nan)).copy()
        known = np.isfinite(values[other])
        column[mine] = np.where(known, values[other], column[mine])
        columns[name] = column

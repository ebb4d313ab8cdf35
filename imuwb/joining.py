"""Joins two files to one log, for example an IMU's and a receiver's, and shifts the clock of a receiver."""

from collections.abc import Iterator
from dataclasses import fields, replace
from typing import Literal, TypeVar

from imuwb.errors import MissingDataError
from imuwb.log import SECOND, GnssStream, ImuStream, Log, Origin, Reference, Triad
from imuwb.notes import Note
from imuwb.units import Epoch


def joined(log: Log, other: Log) -> Log:
    """Return a log with the receivers, references and speeds of another log, and notes on their file and clock.

    Raises:
        MissingDataError: the other log has no receiver, reference or speed.
    """
    if not (other.gnss or other.references or other.speeds):
        streams = ", ".join(imu.name for imu in other.imus) or "; ".join(other.notes) or "no stream that imuwb reads"
        raise MissingDataError(
            f"{other.provenance.path}: there is no receiver, reference or speed to join; the file has {streams}"
        )
    return replace(
        log,
        gnss=(*log.gnss, *other.gnss),
        references=(*log.references, *other.references),
        speeds=(*log.speeds, *other.speeds),
        truth={**other.truth, **log.truth},
        settings={**other.settings, **log.settings},
        devices={**other.devices, **log.devices},
        notes=(*log.notes, *_notes(log, other)),
    )


def with_sensors(log: Log, other: Log) -> Log:
    """Return a log whose first IMU has also the sensors of another log's first IMU: gyro, accelerometer, temperature.

    Each sensor keeps its own times. A sensor of a file that lies beside the log, and was joined by its name, gives way.

    Raises:
        MissingDataError: the other log has no IMU, or none of its sensors is missing in the log.
    """
    where = other.provenance.path
    if not other.imus:
        raise MissingDataError(f"{where}: there is no gyro, accelerometer or temperature of an IMU to join")
    own, added = log.imus[0] if log.imus else None, other.imus[0]
    sensors = [field.name for field in fields(ImuStream) if field.name not in ("name", "origin")]
    given = {name: getattr(added, name) for name in sensors if getattr(added, name) is not None}
    by_name = any(getattr(note, "id", "") == "partner" for note in log.notes)
    new = {name: value for name, value in given.items() if own is None or getattr(own, name) is None or by_name}
    if not new:
        names = ", ".join(name.replace("_", " ") for name in given)
        raise MissingDataError(f"{where}: nothing to join: the log {log.provenance.path} has {names} of its own")
    imu = added if own is None else replace(own, **new, origin=_origin_of_both(own, added))
    names = ", ".join(name.replace("_", " ") for name in new)
    left_out = ", ".join(name.replace("_", " ") for name in given if name not in new)
    text = f"{where} ({other.provenance.hash}): its {names} {'is' if len(new) == 1 else 'are'} joined to {imu.name}"
    notes = [
        Note("sensors_joined", text + (f"; its {left_out} is not used, because the log has one" if left_out else ""))
    ]
    if own is not None and own.origin.epoch != added.origin.epoch:
        text = (
            f"{where}: it has {added.origin.epoch} time, the log {own.origin.epoch} time; the times are used unchanged"
        )
        notes.append(Note("clocks_differ", text))
    elif own is not None and not _both_at_once(own, added):
        text = f"{where}: none of its times lies within those of {own.name}; check that the two files are of one record"
        notes.append(Note("no_overlap", text))
    if own is not None and own.origin.frame.split()[:1] != added.origin.frame.split()[:1]:
        text = (
            f"{where}: its frame is {added.origin.frame}, that of the log {own.origin.frame}; each is converted to FRD as it is; if both "
            "sensors have the same axes, state --frame"
        )
        notes.append(Note("frames_differ", text))
    more = (note for note in other.notes if note not in log.notes)
    return replace(log, imus=(imu, *log.imus[1:]), notes=(*log.notes, *notes, *more))


def _origin_of_both(own: ImuStream, added: ImuStream) -> Origin:
    """Return the origin of an IMU from two files: the units and repairs of both."""
    units = ", ".join(dict.fromkeys((*own.origin.units.split(", "), *added.origin.units.split(", "))))
    more = tuple(repair for repair in added.origin.repairs if repair not in own.origin.repairs)
    return replace(own.origin, units=units, repairs=(*own.origin.repairs, *more))


def _both_at_once(own: ImuStream, added: ImuStream) -> bool:
    """Return whether two IMUs have sensors that overlap in time."""
    first, second = (
        [x for x in (i.angular_rate, i.specific_force, i.temperature) if x is not None and len(x)] for i in (own, added)
    )
    return any(a.time[0] <= b.time[-1] and b.time[0] <= a.time[-1] for a in first for b in second)


def shifted(other: Log, shift: int | Literal["start"], log: Log) -> Log:
    """Return a log whose receivers, references and speeds are on the clock of another log's IMU, and a note on the shift.

    Args:
        other: the log to be shifted; its IMUs keep their times.
        shift: ns that are added to the times; "start": its first time becomes that of the other log's IMU.
        log: the log with the IMU.

    Raises:
        MissingDataError: there is nothing to shift, or no IMU.
    """
    streams = (*other.gnss, *other.references, *other.speeds)
    triads = _triads(log)
    if not streams or not triads:
        raise MissingDataError(
            f"{other.provenance.path}: there is no receiver, reference or speed whose clock can be shifted to that of an IMU"
        )
    if shift == "start":
        shift = min(int(t.time[0]) for t in triads) - min(int(s.time[0]) for s in streams)
    epoch = log.imus[0].origin.epoch
    text = (
        f"{other.provenance.path}: {shift / SECOND:.3f} s are added to the times of its receivers, references and speeds, which "
        f"then have the IMU's clock ({epoch} time)"
    )
    return replace(
        other, gnss=tuple(_moved(s, shift, epoch) for s in other.gnss),
        references=tuple(_moved(s, shift, epoch) for s in other.references),
        speeds=tuple(replace(s, time=s.time + shift) for s in other.speeds),
        zero=None, notes=(*other.notes, Note("clock_shifted", text)),
    )  # fmt: skip


_Located = TypeVar("_Located", GnssStream, Reference)


def _moved(stream: _Located, shift: int, epoch: Epoch) -> _Located:
    return replace(stream, time=stream.time + shift, origin=replace(stream.origin, epoch=epoch))


def _triads(log: Log) -> list[Triad]:
    return [t for imu in log.imus for t in (imu.angular_rate, imu.specific_force) if t is not None and len(t)]


def _notes(log: Log, other: Log) -> Iterator[str]:
    file = f"{other.provenance.path} ({other.provenance.hash})"
    yield Note("joined", f"{file}: its receivers, references and speeds are joined to the log")
    yield from (note for note in other.notes if note not in log.notes)
    epochs = {stream.origin.epoch for stream in (*log.imus, *log.gnss)}
    others = {stream.origin.epoch for stream in (*other.gnss, *other.references)}
    if epochs and others and epochs != others:
        clocks = f"{', '.join(sorted(others))} time, while the IMU has {', '.join(sorted(epochs))} time"
        text = f"{file}: it has {clocks}; the times are used unchanged; --gnss-shift changes them"
        yield Note("clocks_differ", text)
    elif not _overlaps(log, other):
        text = f"{file}: none of its times lies within those of the IMU; check that the two belong together, or state --gnss-shift"
        yield Note("no_overlap", text)


def _overlaps(log: Log, other: Log) -> bool:
    """Return whether any stream of the other log overlaps an IMU in time; True without an IMU."""
    triads = _triads(log)
    streams = (*other.gnss, *other.references, *other.speeds)
    return not triads or any(s.time[0] <= t.time[-1] and s.time[-1] >= t.time[0] for s in streams for t in triads)

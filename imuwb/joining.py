"""Joins two files to one log, for example an IMU's and a receiver's."""

from collections.abc import Iterator
from dataclasses import replace

from imuwb.errors import MissingDataError
from imuwb.log import Log
from imuwb.notes import Note


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
        notes=(*log.notes, *_notes(log, other)),
    )


def _notes(log: Log, other: Log) -> Iterator[str]:
    file = f"{other.provenance.path} ({other.provenance.hash})"
    yield Note("joined", f"{file}: its receivers, references and speeds are joined to the log")
    yield from (note for note in other.notes if note not in log.notes)
    epochs = {stream.origin.epoch for stream in (*log.imus, *log.gnss)}
    others = {stream.origin.epoch for stream in (*other.gnss, *other.references)}
    if epochs and others and epochs != others:
        clocks = f"{', '.join(sorted(others))} time, while the IMU has {', '.join(sorted(epochs))} time"
        yield Note("clocks_differ", f"{file}: it has {clocks}; the times are used unchanged")
    elif not _overlaps(log, other):
        yield Note(
            "no_overlap", f"{file}: none of its times lies within those of the IMU; check that the two belong together"
        )


def _overlaps(log: Log, other: Log) -> bool:
    """Return whether any stream of the other log overlaps an IMU in time; True without an IMU."""
    triads = [t for imu in log.imus for t in (imu.angular_rate, imu.specific_force) if t is not None]
    streams = (*other.gnss, *other.references, *other.speeds)
    return not triads or any(s.time[0] <= t.time[-1] and s.time[-1] >= t.time[0] for s in streams for t in triads)

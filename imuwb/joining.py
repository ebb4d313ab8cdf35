"""Several files that make one log: an IMU's and its receiver's, say."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from imuwb.errors import MissingDataError

if TYPE_CHECKING:
    from imuwb.log import Log


def _meet(log: Log, other: Log) -> bool:
    """Return whether any stream of the other overlaps an IMU in time; yes where there is no IMU."""
    triads = [t for imu in log.imus for t in (imu.angular_rate, imu.specific_force) if t is not None]
    streams = (*other.gnss, *other.references, *other.speeds)
    return not triads or any(s.time[0] <= t.time[-1] and s.time[-1] >= t.time[0] for s in streams for t in triads)


def joined(log: Log, other: Log) -> Log:
    """Return a log with the receivers, references and speeds of another; a note says where they are from, and on which clock.

    Raises:
        MissingDataError: the other has none of these.
    """
    if not (other.gnss or other.references or other.speeds):
        there = ", ".join(imu.name for imu in other.imus) or "; ".join(other.notes) or "nothing that is read"
        message = f"{other.provenance.path}: no receiver, reference or speed to be joined (it has {there})"
        raise MissingDataError(message)
    epochs = {stream.origin.epoch for stream in (*log.imus, *log.gnss)}
    others = {stream.origin.epoch for stream in (*other.gnss, *other.references)}
    where = f"{other.provenance.path} ({other.provenance.hash})"
    notes = [f"{where}: its receivers, references and speeds are joined"]
    notes += [note for note in other.notes if note not in log.notes]
    if epochs and others and epochs != others:
        notes.append(
            f"{where}: runs on another clock ({', '.join(sorted(others))} time against {', '.join(sorted(epochs))} time of the "
            "IMU): times are as they stand"
        )
    elif not _meet(log, other):
        notes.append(f"{where}: not one of its times lies within those of the IMU: the two were not recorded together")
    return replace(
        log,
        gnss=(*log.gnss, *other.gnss),
        references=(*log.references, *other.references),
        speeds=(*log.speeds, *other.speeds),
        notes=(*log.notes, *notes),
    )

"""Several files that make one log: an IMU's and its receiver's, say."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from imuwb.log import Log


def joined(log: Log, other: Log) -> Log:
    """Return a log with the receivers, references and speeds of another; a note says where they are from, and on which clock."""
    epochs = {stream.origin.epoch for stream in (*log.imus, *log.gnss)}
    others = {stream.origin.epoch for stream in (*other.gnss, *other.references)}
    where = f"{other.provenance.path} ({other.provenance.hash})"
    notes = [f"{where}: its receivers, references and speeds are joined", *other.notes]
    if epochs and others and epochs != others:
        notes.append(
            f"{where}: runs on another clock ({', '.join(sorted(others))} time against {', '.join(sorted(epochs))} time of the "
            "IMU): times are as they stand"
        )
    return replace(
        log,
        gnss=(*log.gnss, *other.gnss),
        references=(*log.references, *other.references),
        speeds=(*log.speeds, *other.speeds),
        notes=(*log.notes, *notes),
    )

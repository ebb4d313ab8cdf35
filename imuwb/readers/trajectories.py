"""Reads a trajectory from a file of any known kind: a log with a reference or a receiver, or a table without a header."""

from dataclasses import replace
from pathlib import Path

from imuwb.errors import UsageError
from imuwb.geodesy.local_track import LocalTrack
from imuwb.log import Log, Reference
from imuwb.readers.bytes import source
from imuwb.readers.read_options import ReadOptions
from imuwb.readers.reading import read, reader_of
from imuwb.readers.text.trajectory_tables import row_length, trajectory_table


def read_trajectory(
    path: str | Path, times: Path | None = None, near: int | None = None
) -> Log | LocalTrack | Reference:
    """Return what a file has of a trajectory.

    Args:
        path: a log, perhaps with ``#NAME`` of one of its receivers, references or odometries after it, such as MCAP, RTKLIB ``.pos`` or CSV with a header line; or a table without a header: TUM, poses of
            KITTI, or the navigation file of KF-GINS.
        times: file with one time (s) for each pose of KITTI.
        near: ns since 1970, a time of the same drive; it gives the week of times of week whose week is not stated.

    Raises:
        UnreadableLogError: the file cannot be read.
        UsageError: the file needs an option.
    """
    path = Path(path)
    name, mark, topic = str(path).rpartition("#")
    if mark and name and not path.exists():
        return _of_topic(read(name, ReadOptions()), topic)
    source.check(path)
    if reader_of(path).format == "csv" and row_length(path):
        return trajectory_table(path, times, near)
    if times is not None:
        raise UsageError(f"{path}: the file states its own times; leave --truth-times out")
    return read(path, ReadOptions())


def _of_topic(log: Log, name: str) -> Log:
    """Return a log with one stream only."""
    streams = (*log.references, *log.gnss, *log.poses)
    if name not in (stream.name for stream in streams):
        known = ", ".join(stream.name for stream in streams) or "none"
        raise UsageError(f"{log.provenance.path}: there is no trajectory {name!r}; the file has {known}")
    return replace(
        log,
        references=tuple(r for r in log.references if r.name == name),
        gnss=tuple(g for g in log.gnss if g.name == name),
        poses=tuple(p for p in log.poses if p.name == name),
    )

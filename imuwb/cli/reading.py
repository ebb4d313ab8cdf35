"""Reads the log of a command, and cuts it to the part that the user wants."""

from pathlib import Path

from imuwb import joining, readers, selection
from imuwb.cli.options import Part
from imuwb.cli.terminal import progress
from imuwb.log import Log
from imuwb.readers.read_options import ReadOptions


def read_log(path: Path, reading: ReadOptions, part: Part | None = None) -> Log:
    """Return a log, joined with the log of the GNSS receiver if there is one, and cut to a part."""
    log = _read(path, reading)
    if part is None:
        return log
    if part.gnss is not None:
        log = joining.joined(log, _read(part.gnss, ReadOptions()))
    return selection.select(log, part.imu, part.start, part.end)


def _read(path: Path, reading: ReadOptions) -> Log:
    with progress(f"reading {path.name}") as report:
        return readers.read(path, reading, report)

"""From a Log to a file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from imuwb.errors import UsageError
from imuwb.writers.beside import beside, write_text

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from imuwb.log import Log

    Progress = Callable[[int, int], None]

__all__ = ["SUFFIXES", "beside", "places", "write", "write_text"]

SUFFIXES = (".mcap", ".csv")


def places(log: Log, path: Path) -> tuple[Path, ...]:
    """Return the files that ``write`` would make: CSV has a table for each kind of stream, and a sidecar beside it."""
    if path.suffix != ".csv":
        return (path,)
    from imuwb.writers import csv_text  # noqa: PLC0415 - only what is asked for

    return csv_text.places(log, path)


def write(log: Log, path: Path, progress: Progress | None = None) -> None:
    """Write a log; the suffix chooses the format.

    Args:
        log: what to write.
        path: ``*.mcap`` (ROS 2 messages) or ``*.csv``.
        progress: called with (rows done, rows).

    Raises:
        UsageError: another suffix.
        ImuwbError: the file cannot be written.
    """
    if path.suffix == ".mcap":
        from imuwb.writers.mcap_log import write_mcap  # noqa: PLC0415 - only what is asked for

        write_mcap(log, path, progress)
    elif path.suffix == ".csv":
        from imuwb.writers.csv_text import write_csv  # noqa: PLC0415

        write_csv(log, path, progress)
    else:
        message = f"{path}: a log is written as {' or '.join(SUFFIXES)}; {path.suffix or 'no suffix'!r} is neither"
        raise UsageError(message)

"""Write a Log to files."""

from pathlib import Path

from imuwb.axes import check_scaled
from imuwb.errors import UsageError
from imuwb.log import Log
from imuwb.progress import Progress
from imuwb.writers.whole import together, whole_file, write_text

__all__ = ["SUFFIXES", "places", "together", "whole_file", "write", "write_text"]

SUFFIXES = (".mcap", ".csv")


def places(log: Log, path: str | Path) -> tuple[Path, ...]:
    """Return the files that ``write`` would make; CSV has a table for each kind of stream, and a sidecar for each table."""
    path = Path(path)
    if path.suffix != ".csv":
        return (path,)
    from imuwb.writers import csv_text  # noqa: PLC0415 - pyarrow is slow to import

    return csv_text.places(log, path)


def write(log: Log, path: str | Path, progress: Progress | None = None) -> None:
    """Write a log; the suffix of the path is the format.

    Args:
        log: the log.
        path: ``*.mcap`` (ROS 2 messages) or ``*.csv``.
        progress: called with (rows done, rows).

    Raises:
        UsageError: another suffix.
        ImuwbError: the file cannot be written.
    """
    path = Path(path)
    for imu in log.imus:
        check_scaled(log.provenance.path, imu, "a new log")
    if path.suffix == ".mcap":
        from imuwb.writers.mcap_log import write_mcap  # noqa: PLC0415 - only the writer that is needed

        write_mcap(log, path, progress)
    elif path.suffix == ".csv":
        from imuwb.writers.csv_text import write_csv  # noqa: PLC0415

        write_csv(log, path, progress)
    else:
        raise UsageError(f"{path}: the suffix is {path.suffix!r}; it must be {' or '.join(SUFFIXES)}")

"""Reads a part of a log: the same streams as of the whole log, cut afterwards, from fewer rows."""

from collections.abc import Callable, Iterator
from dataclasses import replace

from imuwb.errors import MissingDataError, UnreadableLogError
from imuwb.log import Log
from imuwb.notes import Note
from imuwb.readers.batch import Batch, CannotSeekError, Limits, Remark
from imuwb.readers.part_rows import PartRows
from imuwb.selection import Part, select

#: Opens the log: with limits only the part is read, where the file allows this; without, everything from its beginning.
Opened = Callable[[Limits | None], Iterator[Batch | Remark]]
Assembled = Callable[[Iterator[Batch | Remark]], Log]
PART = "only the part is read: repairs, faults and notes of the reader are those of the part"
EVENED = "; even times are found from the rows of the part, so they may differ from those of the whole log by less than the stamps scatter"
SET_BACK = "the whole log is read, because its clock is set back or has damaged stamps, which changes later times"
COUNTED = "the whole log is read, because --rate counts its rows from the first one on"


def read_part(opened: Opened, assembled: Assembled, part: Part, *, counted: bool) -> Log:
    """Return a part of a log. If its rows depend on rows far from it, all rows are read and kept, and a note says so.

    Args:
        opened: opens the log.
        assembled: makes a log of what was read.
        part: the part.
        counted: whether the times are counted from the first row on.

    Errors are those of ``select``, and of the reader.
    """
    if counted:
        return _cut(assembled(opened(None)), part, COUNTED)
    rows, log = _alone(opened, assembled, part)
    if log is None:
        return _cut(assembled(opened(None)), part, SET_BACK)
    try:
        return _cut(log, part, PART)
    except MissingDataError:
        if not rows.sought:
            raise
    # What was not read may have what is missing, or be named in the error.
    _, log = _alone(lambda _: opened(None), assembled, part)
    return _cut(assembled(opened(None)), part, SET_BACK) if log is None else _cut(log, part, PART)


def _cut(log: Log, part: Part, text: str) -> Log:
    """Return the part of a log, with a note on how it was read."""
    evened = text == PART and any(repair.effect == "time" for imu in log.imus for repair in imu.origin.repairs)
    log = replace(log, notes=(*log.notes, Note("part", text + (EVENED if evened else ""))))
    return select(log, part.imu, part.start, part.end)


def _alone(opened: Opened, assembled: Assembled, part: Part) -> tuple[PartRows, Log | None]:
    """Return a log with the rows of the part, and with the first rows of all streams; None if other rows change these."""
    rows = PartRows(part)
    log = _read(opened, assembled, rows)
    if rows.in_order and not (rows.near(log) and rows.whole_imu(log)):
        rows = PartRows(part, zero=log.zero, every_imu=not rows.whole_imu(log))
        log = _read(opened, assembled, rows)
    return rows, log if rows.in_order and rows.near(log) else None


def _read(opened: Opened, assembled: Assembled, rows: PartRows) -> Log:
    try:
        return assembled(rows.kept(opened(rows.limits)))
    except CannotSeekError:
        pass
    except UnreadableLogError:  # a log may be readable though a part of it is not
        if not rows.sought:
            raise
    rows.reset()
    return assembled(rows.kept(opened(None)))

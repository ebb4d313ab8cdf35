"""Reads the log of a command, and cuts it to the part that the user wants."""

from collections.abc import Sequence
from dataclasses import replace
from decimal import Decimal, InvalidOperation
from typing import Literal

from imuwb import joining, readers, selection
from imuwb.cli.options import Part
from imuwb.cli.terminal import progress
from imuwb.errors import UsageError
from imuwb.log import SECOND, Log
from imuwb.readers.bytes.address import Place, place_of
from imuwb.readers.bytes.remote import RemoteLog
from imuwb.readers.read_options import ReadOptions

LARGEST_SHIFT = 4e9  #: s


def read_log(place: Place | RemoteLog, reading: ReadOptions, part: Part | None = None) -> Log:
    """Return a log, or a part of it, joined with the other files that the user names."""
    if part is None:
        return _read(place, reading)
    shift = None if part.gnss_shift is None else _shift(part.gnss_shift)
    wanted = selection.Part(None if part.imu == selection.ALL else part.imu, part.start, part.end)
    if part.join:  # the part is cut when all sensors are there
        log = joined_sensors(_read(place, reading), reading, part.join)
    elif shift is None or (part.gnss is not None and shift != "start"):
        log = _read(place, reading, wanted)
        wanted = replace(wanted, imu=None)  # the IMU is chosen; a receiver's log is cut below
    else:  # the shift depends on the whole log
        log = _read(place, reading)
    if part.gnss is not None:
        other = _read(place_of(part.gnss), ReadOptions())
        log = joining.joined(log, other if shift is None else joining.shifted(other, shift, log))
    elif shift is not None:
        log = joining.shifted(log, shift, log)
    return selection.select(log, wanted.imu, wanted.start, wanted.end)


def joined_sensors(log: Log, reading: ReadOptions, files: Sequence[str]) -> Log:
    """Return a log with the sensors of other files, which are read with the same options apart from the names of columns."""
    for file in files:
        log = joining.with_sensors(log, _read(place_of(file), replace(reading, columns=())))
    return log


def _shift(text: str) -> int | Literal["start"]:
    """Return the ns that are added to the times of a receiver, or "start"."""
    if text == "start":
        return "start"
    try:
        seconds = Decimal(text)
    except InvalidOperation:
        seconds = Decimal("nan")
    if not seconds.is_finite() or abs(seconds) >= LARGEST_SHIFT:
        raise UsageError(f"--gnss-shift is {text!r}; it must be start, or a number of seconds below {LARGEST_SHIFT:g}")
    return int((seconds * SECOND).to_integral_value())


def _read(place: Place | RemoteLog, reading: ReadOptions, part: selection.Part | None = None) -> Log:
    with progress(f"reading {place.name}") as report:
        return readers.read(place, reading, report, part)

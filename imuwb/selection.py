"""Keeps one IMU of a log, or the part between two times."""

import re
from dataclasses import dataclass, replace
from datetime import datetime
from typing import TypeVar

import numpy as np

from imuwb.errors import MissingDataError, UsageError
from imuwb.geodesy.local_track import LocalTrack
from imuwb.log import GnssStream, ImuStream, Log, Orientation, Reference, Scalars, Triad
from imuwb.notes import Note
from imuwb.units import SECOND, unix_nanoseconds

Timed = TypeVar("Timed", Triad, Scalars, GnssStream, Reference, LocalTrack, Orientation)
FAR = np.iinfo(np.int64).max
#: a sensor's word in a name: /camera/gyro/sample, imu_accelerometer, Gyro_0, angular_velocity
SENSOR = re.compile(
    r"(?<![a-z])(?:(gyro(?:scope|meter)?s?|gyr|angular_?(?:velocity|rate))"
    r"|accel(?:erometer|eration)?s?|acc|linear_?acceleration)(?![a-z])",
    re.IGNORECASE,
)
RULE = "A+B takes the gyro of A and the accelerometer of B"
ALL = "all"  #: in place of an IMU's name: each IMU
LONGEST = 1e9  #: s, thirty years


@dataclass(frozen=True, slots=True)
class Part:
    """The part of a log that is wanted, as ``select`` takes it; without a value it is the whole log."""

    imu: str | None = None
    start: str | None = None
    end: str | None = None


def select(log: Log, imu: str | None = None, start: str | None = None, end: str | None = None) -> Log:
    """Return the part of a log between two times, with one IMU if it is named.

    Args:
        log: the whole log.
        imu: the name of an IMU, or ``A+B`` for the gyro of A with the accelerometer of B (or the reverse, if only the reverse
            is possible or A is named after an accelerometer); None or ``all`` keeps all IMUs.
        start: seconds from the log's start (``"12.5"``) or an ISO date (``"2024-05-01T12:00:00"``, UTC unless it states a
            zone); None: the log's start.
        end: in the same form; None: the log's end.

    Raises:
        MissingDataError: there is no such IMU (the message lists all), or no row between the times.
        UsageError: ``start`` or ``end`` is no time, ``end`` is not after ``start``, or ``A+B`` names one IMU twice.
    """
    if imu is not None and imu != ALL:
        log = _with_one_imu(log, imu)
    if start is None and end is None:
        return log
    first, last = limits(Part(None, start, end), log.zero or 0, _epoch(log))
    cut = replace(
        log,
        imus=tuple(x for x in (_cut_imu(x, first, last) for x in log.imus) if x.axes()),
        gnss=_kept(log.gnss, first, last),
        speeds=_kept(log.speeds, first, last),
        references=_kept(log.references, first, last),
        poses=_kept(log.poses, first, last),
        orientations=_kept(log.orientations, first, last),
        provenance=replace(log.provenance, selection=f"{start or 'start'} to {end or 'end'}"),
    )
    _check_not_empty(log, cut)
    return cut


def each_imu(log: Log) -> tuple[Log, ...]:
    """Return one log for each IMU that has samples; its other streams are the same."""
    return tuple(replace(log, imus=(imu,)) for imu in log.imus if imu.axes())


def with_first(log: Log, name: str) -> Log:
    """Return the log with the IMU of a name first, which is the one that an analysis of one IMU uses."""
    return replace(log, imus=tuple(sorted(log.imus, key=lambda imu: imu.name != name)))


def limits(part: Part, zero: int, epoch: str) -> tuple[int, int]:
    """Return the first time of a part, and the time before which it ends, ns on the log's clock.

    Raises:
        UsageError: ``start`` or ``end`` is no time on this clock, or ``end`` is not after ``start``.
    """
    first = -FAR if part.start is None else _instant(part.start, zero, epoch)
    last = FAR if part.end is None else _instant(part.end, zero, epoch)
    if last <= first:
        raise UsageError(f"--end {part.end} must be after --start {part.start}")
    return first, last


def separations(name: str) -> list[tuple[str, str]]:
    """Return what ``A+B`` may stand for, because a name may itself contain "+": each "+" separates two names."""
    return [(name[:at], name[at + 1 :]) for at, letter in enumerate(name) if letter == "+"]


def without_sensor(name: str) -> str:
    """Return a name with a star in place of the sensor's last word; a name without such a word as it is."""
    words = [*SENSOR.finditer(name)]
    return f"{name[: words[-1].start()]}*{name[words[-1].end() :]}" if words else name


def joined_name(name: str) -> str:
    """Return the name of the IMU that a half of this name is joined to, if it is: /camera/imu/sample for /camera/gyro/sample."""
    pattern = without_sensor(name)
    return pattern.removesuffix("/*").replace("*", "imu") if pattern != "*" else "imu"


def _half(log: Log, name: str) -> ImuStream | None:
    """Return the half of an IMU that was joined from two, by the half's own name; None if there is none."""
    words = [*SENSOR.finditer(name)]
    joined = next((imu for imu in log.imus if words and imu.name == joined_name(name)), None)
    if joined is None:
        return None
    other = "specific_force" if words[-1][1] else "angular_rate"
    return replace(joined, **{"name": name, other: None})


def _check_not_empty(log: Log, cut: Log) -> None:
    samples = sum(len(t) for x in cut.imus for t in (x.angular_rate, x.specific_force) if t is not None)
    others = sum(len(x) for x in (*cut.gnss, *cut.speeds, *cut.references))
    if not samples and (log.imus or not others):
        rows = "IMU sample" if log.imus else "row"
        start, _, end = cut.provenance.selection.partition(" to ")
        raise MissingDataError(f"{log.provenance.path}: there is no {rows} between {start} and {end}")


def _with_one_imu(log: Log, name: str) -> Log:
    """Return the log with one IMU: the one of that name, or the gyro of one with the accelerometer of another."""
    for imu in log.imus:
        if imu.name == name:
            return replace(log, imus=(imu,))
    parts = {part: imu for imu in log.imus for part in (imu.name, *imu.name.split("+"))}
    pairs = separations(name)
    if (half := _half(log, name)) is not None:
        return replace(log, imus=(half,))
    for part in {part for pair in pairs for part in pair} - parts.keys():
        if (half := _half(log, part)) is not None:
            parts[part] = half
    if any(first and first == second for first, second in pairs):
        raise UsageError(f"--imu {name} names the same IMU twice; the name alone selects both sensors")
    for first, second in pairs:
        if first in parts and second in parts:
            return _composed(log, name, (first, parts[first]), (second, parts[second]))
    names = ", ".join(imu.name for imu in log.imus) or "none"
    rule = f"; {RULE}" if pairs else ""
    raise MissingDataError(f"{log.provenance.path}: there is no IMU {name!r}; the log has: {names}{rule}")


def _composed(log: Log, name: str, first: tuple[str, ImuStream], second: tuple[str, ImuStream]) -> Log:
    """Return the log with one IMU: the gyro of one stream and the accelerometer of another."""
    for (gyro_name, gyro), (accel_name, accel) in ((first, second), (second, first)):
        rate, force = gyro.angular_rate, accel.specific_force
        if rate is None or force is None or "accel" in gyro_name:
            continue
        more = tuple(r for r in accel.origin.repairs if r not in gyro.origin.repairs)
        origin = replace(gyro.origin, repairs=(*gyro.origin.repairs, *more))
        imu = ImuStream(name, rate, force, accel.temperature or gyro.temperature, origin)
        note = Note("composed", f"{name}: the gyro of {gyro_name} and the accelerometer of {accel_name}")
        return replace(log, imus=(imu,), notes=(*log.notes, note))
    raise _no_composition(log, name, (first, second))


def _no_composition(log: Log, name: str, parts: tuple[tuple[str, ImuStream], ...]) -> MissingDataError:
    """Return the error that states why two IMUs cannot be composed."""
    missing = [
        f"{part} has no {'gyro' if imu.angular_rate is None else 'accelerometer'}"
        for part, imu in parts
        if imu.angular_rate is None or imu.specific_force is None
    ]
    why = ", ".join(missing) or "both names are those of accelerometers"
    return MissingDataError(f"{log.provenance.path}: --imu {name} is not possible ({why}); {RULE}")


def _epoch(log: Log) -> str:
    epochs = {stream.origin.epoch for stream in (*log.imus, *log.gnss, *log.references)}
    if len(epochs) > 1:
        raise UsageError(
            f"{log.provenance.path}: --start and --end need one clock, but the streams have several "
            f"({', '.join(sorted(epochs))}); omit both options"
        )
    return epochs.pop() if epochs else "log"


def _instant(text: str, zero: int, epoch: str) -> int:
    """Return a time of the command line in ns on the log's clock."""
    try:
        seconds = float(text)
    except ValueError:
        return _date(text, epoch)
    if not 0 <= seconds < LONGEST:
        raise UsageError(
            f"{text!r} is not a time in a log; write 0 to {LONGEST:g} seconds from the log's start, or an ISO date"
        )
    return zero + round(seconds * SECOND)


def _date(text: str, epoch: str) -> int:
    try:
        when = datetime.fromisoformat(text)
    except ValueError:
        raise UsageError(
            f"{text!r} is not a time; write seconds from the log's start, or an ISO date such as 2024-05-01T12:00:00"
        ) from None
    if epoch != "unix":
        raise UsageError(
            f"{text!r} is a date, but the log's {epoch} clock has no date; write seconds from the log's start"
        )
    return unix_nanoseconds(when)


def _kept(streams: tuple[Timed, ...], first: int, last: int) -> tuple[Timed, ...]:
    return tuple(part for stream in streams if (part := _cut(stream, first, last)).time.size)


def _cut(stream: Timed, first: int, last: int) -> Timed:
    inside = slice(*np.searchsorted(stream.time, (first, last)))
    columns = {name: getattr(stream, name) for name in stream.__dataclass_fields__}
    return replace(stream, **{name: x[inside] for name, x in columns.items() if isinstance(x, np.ndarray)})


def _cut_imu(imu: ImuStream, first: int, last: int) -> ImuStream:
    names = ("angular_rate", "specific_force", "temperature")
    parts = {name: _cut(part, first, last) for name in names if (part := getattr(imu, name)) is not None}
    return replace(imu, **{name: parts[name] if name in parts and len(parts[name]) else None for name in names})

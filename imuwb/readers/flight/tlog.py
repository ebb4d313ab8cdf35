"""MAVLink telemetry logs (.tlog): IMUs, receivers and the navigation solution of every system in them."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from imuwb.errors import UnreadableLogError
from imuwb.log import MEAN_SEA_LEVEL, Origin
from imuwb.readers.batch import Batch, Remark
from imuwb.readers.bytes import source
from imuwb.readers.bytes.gather import gather
from imuwb.readers.flight.boot_clock import BootClock, boot_clock
from imuwb.readers.flight.mavlink_fields import LAYOUTS, decoded
from imuwb.readers.flight.mavlink_frames import STAMP, scan
from imuwb.readers.flight.receiver import GpsRows, attitude_at, gps_columns, left_out, usable_fixes, usable_position
from imuwb.units import STANDARD_GRAVITY

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    from imuwb.readers.batch import ReadOptions

    Values = Mapping[str, NDArray[Any]]
    #: system, component, message
    Key = tuple[int, int, int]

format = "tlog"  # noqa: A001 - the contract's name
uses = ("time_source",)
MICRO, MILLI = 1000, 1_000_000  #: ns
EARLIEST, LATEST = 946_684_800_000_000, 4_102_444_800_000_000  #: µs of the years 2000 and 2100: what a recorder may say
SYSTEM_TIME, ATTITUDE, SOLUTION = 2, 30, 33
RECEIVERS = (24, 124)
SCALED, RAW, FLOATS = (26, 116, 129), (27,), (105, 107)
CLOCKS = (SYSTEM_TIME, ATTITUDE, SOLUTION, *SCALED)  #: messages with ms since power-up
_ANGLES = ("roll", "pitch", "yaw")
FROZEN = 0.5  #: share of fixes whose stamp repeats, from which on it is no stamp
APART = 60_000_000_000  #: ns between a fix's own time and its arrival, beyond which it is not its time
LSB = "its smallest steps are 1 mG (9.8e-3 m/s²) and 1 mrad/s (206 deg/h): a noise model from it is limited by quantization"


def probe(head: bytes) -> bool:
    """Return whether the file's beginning holds a frame whose checksum holds, behind a possible time."""
    if len(head) < STAMP + 8 or b"\0" not in head:
        return False
    found = scan(np.frombuffer(head, np.uint8), last=False)
    recorded = gather(np.frombuffer(head, np.uint8), found.record, ">u8")
    return bool(((recorded > EARLIEST) & (recorded < LATEST)).any())


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the streams of each system; the file is read first, for its clocks.

    Raises:
        UnreadableLogError: not one frame whose checksum holds.
    """
    log = _Telemetry()
    trouble: list[str] = []
    with source.open_unpacked(path) as file:
        rest, offset = b"", 0
        for block, last in source.blocks(file, trouble):
            data = rest + block
            end = log.take(data, offset, source.position(file), last=last)
            rest, offset = data[end:], offset + end
    if not log.frames:
        message = f"{path}: no MAVLink frame whose checksum holds; {log.skipped} bytes belong to none"
        raise UnreadableLogError(message)
    if log.skipped and not log.rows:
        message = (
            f"{path}: {log.frames} MAVLink frames, none of an IMU, a receiver or a clock, and {log.skipped} bytes that belong "
            "to none; it was cut"
        )
        raise UnreadableLogError(message)
    yield from (Remark(text) for text in trouble)
    yield from log.batches(options)
    yield from log.remarks()


@dataclass(slots=True)
class _Rows:
    """The rows of one message of one component, piece by piece."""

    place: list[NDArray[np.int64]] = field(default_factory=list[Any])
    recorded: list[NDArray[np.int64]] = field(default_factory=list[Any])
    values: list[Values] = field(default_factory=list[Any])

    def joined(self) -> tuple[NDArray[np.int64], NDArray[np.int64], dict[str, NDArray[Any]]]:
        columns = {name: np.concatenate([piece[name] for piece in self.values]) for name in self.values[0]}
        return np.concatenate(self.place), np.concatenate(self.recorded), columns


class _Telemetry:
    """A file on its way: rows by component and message, and what was odd."""

    def __init__(self) -> None:
        self.frames = self.failed = self.unknown = self.skipped = self.impossible = self.bytes_read = 0
        self._rows: dict[Key, _Rows] = defaultdict(_Rows)
        self._clocks: dict[tuple[int, int], BootClock] = {}
        self._notes: list[Remark] = []

    @property
    def rows(self) -> int:
        """Return how many messages of a kind that is used were found."""
        return sum(len(kept.place) for kept in self._rows.values())

    def take(self, data: bytes, offset: int, bytes_read: int, *, last: bool) -> int:
        """Keep the rows of a block; return where the next begins."""
        buffer = np.frombuffer(data, np.uint8)
        found = scan(buffer, last=last)
        self.bytes_read = bytes_read
        self.frames += found.number.size
        self.failed += found.failed
        self.unknown += found.unknown
        self.skipped += found.skipped + (buffer.size - found.end if last else 0)
        recorded = gather(buffer, found.record, ">u8")
        possible = (recorded > EARLIEST) & (recorded < LATEST)
        self.impossible += int(np.count_nonzero(~possible))
        key = (found.system << 40) | (found.component << 32) | found.number
        wanted = np.flatnonzero(possible & np.isin(found.number, list(LAYOUTS)))
        for one in np.unique(key[wanted]):
            rows = wanted[key[wanted] == one]
            number = int(found.number[rows[0]])
            kept = self._rows[int(found.system[rows[0]]), int(found.component[rows[0]]), number]
            kept.place.append(offset + found.record[rows])
            kept.recorded.append(recorded[rows].astype(np.int64) * MICRO)
            kept.values.append(decoded(LAYOUTS[number], buffer, found.payload[rows], found.length[rows]))
        return found.end

    def batches(self, options: ReadOptions) -> Iterator[Batch]:
        rows = {key: self._rows.pop(key).joined() for key in sorted(self._rows)}
        clocks = {part: _clock(rows, part) for part in dict.fromkeys((s, c) for s, c, _ in rows)}
        # The recorder has one clock: what one component tells of it holds for all.
        ahead = next((clock.ahead for clock in clocks.values() if clock.known), None)
        self._clocks = clocks if ahead is None else {part: clock.with_recorder(ahead) for part, clock in clocks.items()}
        systems = {key[:2] for key in rows if key[2] not in (SYSTEM_TIME, ATTITUDE)}
        for (system, component, number), (place, recorded, values) in rows.items():
            clock = self._clocks[system, component]
            name = LAYOUTS[number].name if len(systems) == 1 else f"{system}.{component}.{LAYOUTS[number].name}"
            arrived = recorded if options.time_source != "header" else recorded + clock.ahead
            if number in (*SCALED, *RAW, *FLOATS):
                time = arrived if options.time_source != "header" else _own_time(clock, place, values)
                yield from self._imu(name, number, time, values)
            elif number in RECEIVERS:
                time = (
                    self._fix_time(name, clock, place, arrived, values) if options.time_source == "header" else arrived
                )
                yield from self._receiver(name, time, values)
            elif number == SOLUTION:
                time = arrived if options.time_source != "header" else _own_time(clock, place, values)
                attitude = rows.get((system, component, ATTITUDE))
                yield from self._solution(name, clock, time, values, attitude, own=options.time_source == "header")

    def remarks(self) -> Iterator[Remark]:
        yield from self._notes
        for (system, component), clock in self._clocks.items():
            if clock.reboots:
                yield Remark(
                    f"system {system}, component {component}: {clock.reboots} reboots: its clock steps back; time goes on by "
                    "the recorder's"
                )
        told = [clock.known for clock in self._clocks.values()]
        yield Remark(
            "boot times made Unix time by SYSTEM_TIME"
            if any(told)
            else "boot times made Unix time by the recorder's clock: no message tells the date"
        )
        faults = {
            "frames whose checksum fails, not used": self.failed,
            "frames of messages that no public dialect has, not used": self.unknown,
            "bytes that belong to no frame": self.skipped,
            "frames with an impossible recorder's time, not used": self.impossible,
        }
        yield from (Remark(f"{count} {what}") for what, count in faults.items() if count)

    def _imu(self, name: str, number: int, time: NDArray[np.int64], values: Values) -> Iterator[Batch]:
        floats = number in FLOATS
        force, rate = (1.0, 1.0) if floats else (1e-3 * STANDARD_GRAVITY, 1e-3)
        origin = Origin("rad/s, m/s²" if floats else "mrad/s, mG", "FRD", "unix")
        columns = {
            "angular_rate": _triad(values, "gyro") * rate,
            "specific_force": _triad(values, "acc") * force,
        }
        warmth = values["temperature"].astype(np.float64) * (1.0 if floats else 0.01)
        if not floats:
            self._notes.append(Remark(f"{name}: {LSB}"))
        instance = values["id"] if "id" in values else np.zeros(time.size, np.uint8)
        for one in np.unique(instance):
            rows = instance == one
            stream = name if not one else f"{name}.{one}"
            yield Batch(stream, "imu", time[rows], {k: v[rows] for k, v in columns.items()}, origin, self.bytes_read)
            warm = rows & (warmth != 0)  # 0: there is none
            if warm.any():
                yield Batch(stream, "imu", time[warm], {"temperature": warmth[warm]}, origin, self.bytes_read)

    def _fix_time(
        self, name: str, clock: BootClock, place: NDArray[np.int64], arrived: NDArray[np.int64], values: Values
    ) -> NDArray[np.int64]:
        """Return a receiver's own time where it is one: since power-up, or since 1970; else that of arrival."""
        own = values["time_usec"].astype(np.int64) * MICRO
        time = np.where(values["time_usec"] > EARLIEST, own, clock.unix(place, own))
        bad = np.abs(time - arrived) > APART
        frozen = own.size > 1 and float(np.mean(np.diff(own) == 0)) > FROZEN
        if frozen:
            bad[:] = True
        if bad.any():
            what = (
                "fixes whose own time is frozen" if frozen else "fixes whose own time is 0 or far from that of arrival"
            )
            self._notes.append(Remark(f"{what}: the recorder's time is used", name, int(bad.sum()), "time"))
        return np.where(bad, arrived, time)

    def _receiver(self, name: str, time: NDArray[np.int64], values: Values) -> Iterator[Batch]:
        height, above_sea = values["alt_ellipsoid"] * 1e-3, values["alt"] * 1e-3
        ellipsoid = bool(values["alt_ellipsoid"].any())
        if not ellipsoid:
            self._notes.append(Remark(f"{name}: heights are above mean sea level; none above the ellipsoid is sent"))

        def unless(field: str, unknown: int, factor: float) -> NDArray[np.float64]:
            return np.where(values[field] == unknown, np.nan, values[field] * factor)

        rows = GpsRows(
            values["lat"] * 1e-7, values["lon"] * 1e-7, height if ellipsoid else above_sea,
            unless("vel", 65535, 1e-2), unless("cog", 65535, 1e-2), None, values["fix_type"].astype(np.float64),
            unless("h_acc", 0, 1e-3), unless("v_acc", 0, 1e-3), unless("vel_acc", 0, 1e-3),
        )  # fmt: skip
        there = usable_fixes(rows)
        self._notes += left_out(name, there)
        if there.any():
            columns = {key: column[there] for key, column in gps_columns(rows).items()}
            above = "" if ellipsoid else f" ({MEAN_SEA_LEVEL})"
            origin = Origin(f"1e-7 deg, mm{above}, cm/s", "NED", "unix")
            yield Batch(name, "gnss", time[there], columns, origin, self.bytes_read)

    def _solution(
        self,
        name: str,
        clock: BootClock,
        time: NDArray[np.int64],
        values: Values,
        attitude: Any,  # noqa: ANN401 - joined rows or None
        *,
        own: bool,
    ) -> Iterator[Batch]:
        position = np.stack([
            np.radians(values["lat"] * 1e-7), np.radians(values["lon"] * 1e-7), values["alt"] * 1e-3,
        ], axis=1)  # fmt: skip
        velocity = np.stack([values[f"v{axis}"] * 1e-2 for axis in "xyz"], axis=1)
        columns = {"position": position, "velocity": velocity}
        if attitude is not None:
            place, recorded, angles = attitude
            at = _own_time(clock, place, angles) if own else recorded
            turns = np.stack([angles[name] for name in _ANGLES], axis=1)
            known = np.isfinite(turns).all(axis=1)
            if known.any():
                columns["attitude"] = attitude_at(time, at[known], turns[known])
        there = usable_position(position)
        self._notes += left_out(name, there)
        if there.any():
            self._notes.append(Remark(f"{name}: heights are above mean sea level"))
        if there.any():
            origin = Origin(f"1e-7 deg, mm ({MEAN_SEA_LEVEL}), cm/s", "NED", "unix")
            kept = {key: column[there] for key, column in columns.items()}
            yield Batch(name, "reference", time[there], kept, origin, self.bytes_read)


def _clock(rows: Mapping[Key, tuple[Any, Any, Values]], part: tuple[int, int]) -> BootClock:
    """Return the clock of one component, from all its messages that tell the time since power-up."""
    parts: list[tuple[NDArray[np.int64], ...]] = []
    for number in (*CLOCKS, *RAW, *FLOATS):
        if (*part, number) not in rows:
            continue
        place, recorded, values = rows[*part, number]
        counts = "time_usec" in values
        if counts and (values["time_usec"] > EARLIEST).any():
            continue  # it tells Unix time
        boot = values["time_usec"].astype(np.int64) * MICRO if counts else _boot(values)
        told = values.get("time_unix_usec", np.zeros(place.size, np.uint64))
        parts.append((place, boot, recorded, np.where(told < LATEST, told, 0).astype(np.int64) * MICRO))
    if not parts:
        return boot_clock(*[np.empty(0, np.int64)] * 4)
    place, boot, recorded, unix = (np.concatenate(columns) for columns in zip(*parts, strict=True))
    order = np.argsort(place, kind="stable")
    return boot_clock(place[order], boot[order], recorded[order], unix[order])


def _boot(values: Values) -> NDArray[np.int64]:
    return values["time_boot_ms"].astype(np.int64) * MILLI


def _own_time(clock: BootClock, place: NDArray[np.int64], values: Values) -> NDArray[np.int64]:
    if "time_boot_ms" in values:
        return clock.unix(place, _boot(values))
    own = values["time_usec"].clip(0, LATEST).astype(np.int64) * MICRO
    return np.where(values["time_usec"] > EARLIEST, own, clock.unix(place, own))


def _triad(values: Values, sensor: str) -> NDArray[np.float64]:
    return np.stack([values[f"{axis}{sensor}"].astype(np.float64) for axis in "xyz"], axis=1)

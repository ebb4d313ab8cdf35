"""The streams of a telemetry log, on Unix time."""

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from imuwb.arrays import Booleans, Floats, Integers
from imuwb.errors import UnreadableLogError
from imuwb.log import MEAN_SEA_LEVEL, Nanoseconds, Origin
from imuwb.notes import Note
from imuwb.readers.batch import Batch, Remark, unused
from imuwb.readers.flight import trajectory
from imuwb.readers.flight.boot_clock import BootClock, boot_clock
from imuwb.readers.flight.left_out import mavlink_left_out
from imuwb.readers.flight.mavlink_fields import LAYOUTS
from imuwb.readers.flight.telemetry import EARLIEST, LATEST, MICRO, Key, Rows, Telemetry, Values
from imuwb.readers.read_options import ReadOptions
from imuwb.units import STANDARD_GRAVITY

MILLI = 1_000_000  #: ns
SYSTEM_TIME, ATTITUDE, SOLUTION = 2, 30, 33
RECEIVERS = (24, 124)
SCALED, RAW, FLOATS = (26, 116, 129), (27,), (105, 107)
IMUS = (*SCALED, *RAW, *FLOATS)
CLOCKS = (SYSTEM_TIME, ATTITUDE, SOLUTION, *SCALED)  #: messages with ms since power-up
#: bits of ``fields_updated`` that say that a sensor has a new sample. Source: MAVLink, HIGHRES_IMU_UPDATED_FLAGS
UPDATED = {"angular_rate": 0b111000, "specific_force": 0b000111}
DOUBTFUL = 2.0  #: factor between |f| and gravity, beyond which the units of RAW_IMU are not mG and mrad/s
UNKNOWN = 65535  #: speed or course that is not known
FROZEN = 0.5  #: share of fixes; if more fixes repeat the time of the fix before, this time is frozen
APART = 60_000_000_000  #: ns; if a fix's own time differs by more from its arrival, its own time is wrong
LSB = "its smallest steps are 1 mG (9.8e-3 m/s²) and 1 mrad/s (206 deg/h), so quantization limits the noise model of this IMU"
ABOVE_SEA = f" ({MEAN_SEA_LEVEL})"


def streamed(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the streams of each system.

    Raises:
        UnreadableLogError: the file has no frame whose checksum is correct.
    """
    log = Telemetry(path)
    if not log.frames:
        raise UnreadableLogError(
            f"{path}: no MAVLink frame has a correct checksum, and {log.skipped} bytes belong to no frame"
        )
    if log.skipped and not log.has_rows:
        raise UnreadableLogError(
            f"{path}: the file is cut: none of its {log.frames} MAVLink frames is from an IMU, a receiver or a clock, and "
            f"{log.skipped} bytes belong to no frame"
        )
    yield from (Remark(note) for note in log.notes)
    streams = _Streams(log, own_time=options.time_source == "header")
    yield from streams.all()
    yield from (Remark(note) for note in log.faults())
    yield from mavlink_left_out(log.counts, streams.used)


class _Streams:
    """Makes batches from the messages."""

    def __init__(self, log: Telemetry, *, own_time: bool) -> None:
        self._bytes_read, self._own_time = log.bytes_read, own_time
        self._rows = log.rows()
        self.used = {
            *IMUS,
            *RECEIVERS,
            SYSTEM_TIME,
            SOLUTION,
        }  #: messages that are used; an attitude is, with a solution
        self.used |= {ATTITUDE} if any(key[2] == SOLUTION for key in self._rows) else set()
        clocks = {part: _clock(self._rows, part) for part in dict.fromkeys((s, c) for s, c, _ in self._rows)}
        # The recorder has one clock, so what one component states about it is true for all.
        ahead = next((clock.ahead for clock in clocks.values() if clock.known), None)
        self._clocks = clocks if ahead is None else {part: clock.with_recorder(ahead) for part, clock in clocks.items()}
        systems = {key[:2] for key in self._rows if key[2] not in (SYSTEM_TIME, ATTITUDE)}
        self._one_system = len(systems) == 1

    def all(self) -> Iterator[Batch | Remark]:
        """Yield all streams, then notes on the rows, the clocks, and the times of the fixes."""
        remarks: list[Remark] = []
        for key, rows in self._rows.items():
            for part in self._stream(key, rows):
                if isinstance(part, Batch):
                    yield part
                else:
                    remarks.append(part)
        yield from remarks
        for (system, component), clock in self._clocks.items():
            if clock.reboots:
                text = f"system {system}, component {component}: {clock.reboots} reboots; the clock restarts at each"
                yield Remark(Note("reboots", f"{text}, and time goes on by the recorder's clock"))
        if any(clock.known for clock in self._clocks.values()):
            yield Remark(Note("utc_by_message", "boot times converted to Unix time with SYSTEM_TIME"))
        else:
            text = "boot times converted to Unix time with the recorder's clock: no message states the date"
            yield Remark(Note("utc_by_recorder", text))

    def _stream(self, key: Key, rows: Rows) -> Iterator[Batch | Remark]:
        """Yield the stream of one message of one component."""
        system, component, number = key
        place, recorded, values = rows
        clock = self._clocks[system, component]
        name = LAYOUTS[number].name if self._one_system else f"{system}.{component}.{LAYOUTS[number].name}"
        if number in IMUS:
            yield from self._imu(name, number, self._time(clock, place, recorded, values), values)
        elif number in RECEIVERS:
            arrived = recorded + clock.ahead if self._own_time else recorded
            time, remarks = _fix_time(name, clock, place, arrived, values) if self._own_time else (arrived, [])
            yield from remarks
            yield from self._receiver(name, time, values)
        elif number == SOLUTION:
            time = self._time(clock, place, recorded, values)
            yield from self._solution(name, time, values, self._rows.get((system, component, ATTITUDE)), clock)

    def _time(self, clock: BootClock, place: Integers, recorded: Nanoseconds, values: Values) -> Nanoseconds:
        """Return the messages' own time, or the recorder's if the options ask for it."""
        if not self._own_time:
            return recorded
        if "time_boot_ms" in values:
            return clock.unix(place, _boot(values))
        own = values["time_usec"].clip(0, LATEST).astype(np.int64) * MICRO
        return np.where(values["time_usec"] > EARLIEST, own, clock.unix(place, own))

    def _imu(self, name: str, number: int, time: Nanoseconds, values: Values) -> Iterator[Batch | Remark]:
        floats = number in FLOATS
        force, rate, degrees = (1.0, 1.0, 1.0) if floats else (1e-3 * STANDARD_GRAVITY, 1e-3, 0.01)
        origin = Origin("rad/s, m/s²" if floats else "mrad/s, mG", "FRD", "unix")
        columns = {
            "angular_rate": trajectory.triples(values, ("xgyro", "ygyro", "zgyro")) * rate,
            "specific_force": trajectory.triples(values, ("xacc", "yacc", "zacc")) * force,
        }
        temperature = values["temperature"].astype(np.float64) * degrees
        if not floats:
            yield Remark(Note("coarse", f"{name}: {LSB}"))
        instance = values["id"] if "id" in values else np.zeros(time.size, np.uint8)
        for sensor in np.unique(instance):
            rows = instance == sensor
            stream = name if not sensor else f"{name}.{sensor}"
            if number in RAW and (size := _raw_size(columns["specific_force"][rows])) is not None:
                text = f"its |f| is {size:.3g} times gravity where mG is usual, so its units are those of a sensor"
                yield unused([f"{stream} ({int(rows.sum())})"], text)
                continue
            for parts in _updated(values, rows):
                kept = {key: columns[key][own] for key, own in parts.items()}
                stamps = time[next(iter(parts.values()))]
                yield Batch(stream, "imu", stamps, kept, origin, self._bytes_read, exact=True)
            measured = rows & (temperature != 0)  # 0: no thermometer
            if measured.any():
                warm = {"temperature": temperature[measured]}
                yield Batch(stream, "imu", time[measured], warm, origin, self._bytes_read, exact=True)

    def _receiver(self, name: str, time: Nanoseconds, values: Values) -> Iterator[Batch | Remark]:
        def known(field: str, unknown: int, factor: float) -> Floats:
            return np.where(values[field] == unknown, np.nan, values[field] * factor)

        ellipsoid = bool(values["alt_ellipsoid"].any())
        if not ellipsoid:
            text = "heights are above mean sea level; the receiver sends none above the ellipsoid"
            yield Remark(Note("above_sea", f"{name}: {text}"))
        height = values["alt_ellipsoid" if ellipsoid else "alt"] * 1e-3
        speed_sigma = known("vel_acc", 0, 1e-3)
        columns = {
            "position": trajectory.positions(values["lat"] * 1e-7, values["lon"] * 1e-7, height),
            "velocity": trajectory.velocities(known("vel", UNKNOWN, 1e-2), known("cog", UNKNOWN, 1e-2)),
            "position_sigma": trajectory.sigmas(known("h_acc", 0, 1e-3), known("v_acc", 0, 1e-3)),
            "velocity_sigma": trajectory.sigmas(speed_sigma, speed_sigma),
            "fix_type": trajectory.fix_types(values["fix_type"]),
        }
        origin = Origin(f"1e-7 deg, mm{'' if ellipsoid else ABOVE_SEA}, cm/s", "NED", "unix")
        yield from trajectory.located(name, "gnss", time, columns, origin, self._bytes_read)

    def _solution(
        self, name: str, time: Nanoseconds, values: Values, attitude: Rows | None, clock: BootClock
    ) -> Iterator[Batch | Remark]:
        """Yield the navigation solution: position and velocity, with the attitude of another message."""
        position = trajectory.positions(values["lat"] * 1e-7, values["lon"] * 1e-7, values["alt"] * 1e-3)
        columns = {"position": position, "velocity": trajectory.triples(values, ("vx", "vy", "vz")) * 1e-2}
        if attitude is not None:
            place, recorded, angles = attitude
            at, turns = self._time(clock, place, recorded, angles), trajectory.triples(angles, ("roll", "pitch", "yaw"))
            columns |= trajectory.attitudes(time, at, turns)
        origin = Origin(f"1e-7 deg, mm{ABOVE_SEA}, cm/s", trajectory.ESTIMATED, "unix")
        yield from trajectory.located(name, "reference", time, columns, origin, self._bytes_read)
        if trajectory.usable(position).any():
            yield Remark(Note("above_sea", f"{name}: heights are above mean sea level"))


def _raw_size(force: Floats) -> float | None:
    """Return the usual |f| over gravity of a message whose units are not fixed; None if it is about one, or 0."""
    size = float(np.median(np.linalg.norm(force, axis=1))) / STANDARD_GRAVITY
    return None if size == 0 or 1 / DOUBTFUL < size < DOUBTFUL else size


def _updated(values: Values, rows: Booleans) -> Iterator[dict[str, Booleans]]:
    """Yield {quantity: rows} for each clock: rows whose flags say that the sensor has a new sample; without flags, all."""
    flags = values["fields_updated"].astype(np.int64) if "fields_updated" in values else np.zeros(rows.size, np.int64)
    fresh = {quantity: rows & ((flags & bits) == bits) for quantity, bits in UPDATED.items()}
    if not (flags[rows] & (UPDATED["angular_rate"] | UPDATED["specific_force"])).any():
        fresh = dict.fromkeys(UPDATED, rows)  # no flags are set
    one, other = fresh.values()
    if np.array_equal(one, other):
        yield fresh
    else:
        yield from ({quantity: own} for quantity, own in fresh.items() if own.any())


def _fix_time(
    name: str, clock: BootClock, place: Integers, arrived: Nanoseconds, values: Values
) -> tuple[Nanoseconds, list[Remark]]:
    """Return a receiver's own time, since power-up or since 1970; the time of arrival where this time is impossible."""
    own = values["time_usec"].astype(np.int64) * MICRO
    time = np.where(values["time_usec"] > EARLIEST, own, clock.unix(place, own))
    wrong = np.abs(time - arrived) > APART
    frozen = own.size > 1 and float(np.mean(np.diff(own) == 0)) > FROZEN
    if frozen:
        wrong[:] = True
    if not wrong.any():
        return time, []
    why = "is frozen" if frozen else "is 0, or far from that of arrival"
    note = Note(
        "fix_time_frozen" if frozen else "fix_time_wrong", f"fixes with the recorder's time, because their own {why}"
    )
    return np.where(wrong, arrived, time), [Remark(note, name, int(wrong.sum()), "time")]


def _clock(rows: Mapping[Key, Rows], part: tuple[int, int]) -> BootClock:
    """Return the clock of one component, from all its messages that state the time since power-up."""
    parts: list[tuple[Integers, ...]] = []
    for number in (*CLOCKS, *RAW, *FLOATS):
        if (*part, number) not in rows:
            continue
        place, recorded, values = rows[*part, number]
        in_microseconds = "time_usec" in values
        if in_microseconds and (values["time_usec"] > EARLIEST).any():
            continue  # this is Unix time
        boot = values["time_usec"].astype(np.int64) * MICRO if in_microseconds else _boot(values)
        unix = values.get("time_unix_usec", np.zeros(place.size, np.uint64))
        parts.append((place, boot, recorded, np.where(unix < LATEST, unix, 0).astype(np.int64) * MICRO))
    if not parts:
        return boot_clock(*[np.empty(0, np.int64)] * 4)
    place, boot, recorded, unix = (np.concatenate(columns) for columns in zip(*parts, strict=True))
    order = np.argsort(place, kind="stable")
    return boot_clock(place[order], boot[order], recorded[order], unix[order])


def _boot(values: Values) -> Nanoseconds:
    return values["time_boot_ms"].astype(np.int64) * MILLI

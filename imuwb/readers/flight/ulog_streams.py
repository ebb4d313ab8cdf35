"""The streams of a PX4 log, from the topics of its messages."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from imuwb.arrays import Bytes, Floats
from imuwb.errors import UnreadableLogError
from imuwb.geodesy import displaced, euler_of_quaternion
from imuwb.log import MEAN_SEA_LEVEL, Epoch, Nanoseconds, Origin
from imuwb.notes import Note
from imuwb.readers.batch import Batch, Remark
from imuwb.readers.bytes import source
from imuwb.readers.flight import trajectory
from imuwb.readers.flight.boot_clock import EARLIEST
from imuwb.readers.flight.left_out import ulog_left_out
from imuwb.readers.flight.settings import settings_of
from imuwb.readers.flight.ulog_imus import COMBINED, FIFOS, INCREMENTS, MICRO, SELECTION, SENSORS, PX4Imus
from imuwb.readers.flight.ulog_records import ULogFile
from imuwb.texts import counted

Columns = Mapping[str, NDArray[Any]]

RECEIVERS = ("sensor_gps", "vehicle_gps_position")
GLOBAL, LOCAL, ATTITUDE = "vehicle_global_position", "vehicle_local_position", "vehicle_attitude"
WANTED = frozenset((COMBINED, INCREMENTS, SELECTION, *RECEIVERS, GLOBAL, LOCAL, ATTITUDE, *SENSORS.values(), *FIFOS))
#: shape of a row of each field that is no single number; a field of another shape is not PX4's
_SHAPES = {"q": (4,), **dict.fromkeys(("gyro_rad", "accelerometer_m_s2", "delta_angle", "delta_velocity"), (3,))}
ABOVE_SEA = f" ({MEAN_SEA_LEVEL})"  #: for the heights of PX4's own solution, and of receivers in its oldest logs


def streamed(path: Path) -> Iterator[Batch | Remark]:
    """Yield the streams of a log.

    Raises:
        UnreadableLogError: the file has no whole message of data.
    """
    notes: list[str] = []
    log = ULogFile()
    log.take(_bytes(path, notes), WANTED)
    if not log.data:
        raise UnreadableLogError(f"{path}: this PX4 log has no whole message of data; it is cut or damaged")
    yield from (Remark(note) for note in notes)
    streams = _Streams(log, path.stat().st_size)
    yield from streams.all()
    yield from map(Remark, _faults(log))
    yield settings_of(log.stated)
    yield from ulog_left_out(log.counts, streams.used)


def _faults(log: ULogFile) -> Iterator[Note]:
    if log.dropouts:
        count, total, longest = len(log.dropouts), sum(log.dropouts), max(log.dropouts)
        yield Note(
            "dropouts", f"{counted(count, 'dropout')} of the recorder, {total} ms in all, the longest {longest} ms"
        )
    if log.skipped:
        yield Note("no_message", f"{log.skipped} bytes that belong to no message")
    if log.misfits:
        yield Note("short_message", f"{log.misfits} messages that are shorter than their topic's definition, not used")


def _bytes(path: Path, notes: list[str]) -> Bytes:
    with source.open_unpacked(path) as file:
        if source.is_packed(file):
            return np.frombuffer(source.whole(file, notes), np.uint8)
    return np.memmap(path, np.uint8, "r")


class _Streams:
    """Makes batches from the topics."""

    def __init__(self, log: ULogFile, size: int) -> None:
        self._log, self._size = log, size
        self.used = set[str]()  #: topics that are used
        self._offset = self._unix_offset()
        self._epoch: Epoch = "boot" if self._offset is None else "unix"

    def all(self) -> Iterator[Batch | Remark]:
        """Yield all streams, the IMU with most samples first, then a note on the clock."""
        parts = [*PX4Imus(self._topics, self._boot, self._offset or 0, self._epoch, self._size, self.used).all()]
        imus = [part for part in parts if isinstance(part, Batch)]
        rows: dict[str, int] = {}
        for batch in imus:
            rows[batch.stream] = max(rows.get(batch.stream, 0), batch.time.size)
        yield from sorted(imus, key=lambda batch: -rows[batch.stream])
        yield from (part for part in parts if isinstance(part, Remark))
        for topic in RECEIVERS:
            for name, columns in self._topics(topic):
                yield from self._receiver(topic, name, columns)
        yield from self._solution()
        if self._offset is None:
            yield Remark(Note("no_date", "times count from power-up: no fix states the date"))
        else:
            yield Remark(Note("utc_by_receiver", "times since power-up converted to UTC with the receiver's time"))

    def _topics(self, name: str) -> list[tuple[str, Columns]]:
        """Return a topic's instances; if there are several, their names have a number."""
        fifo = name.endswith("_fifo")

        def fits(field: str, values: NDArray[Any]) -> bool:
            return values.ndim == 2 if fifo and field in "xyz" else values.shape[1:] == _SHAPES.get(field, ())  # noqa: PLR2004

        shaped = [(i, {k: _wide(v) for k, v in c.items() if fits(k, v)}) for i, c in self._log.topics(name)]
        timed = [(i, columns) for i, columns in shaped if "timestamp" in columns]
        several = len(timed) > 1 or any(i for i, _ in timed)
        return [(f"{name}.{i}" if several else name, columns) for i, columns in timed]

    def _topic(self, name: str) -> Columns | None:
        """Return a topic with one instance; None otherwise."""
        return dict(self._topics(name)).get(name)

    def _boot(self, columns: Columns) -> Nanoseconds:
        """Return the time since power-up: the time of the samples if it is logged, else the time of the messages."""
        stamp = columns["timestamp"]
        sampled = columns.get("timestamp_sample")
        if sampled is not None and sampled.any():
            stamp = sampled
        return _nanoseconds(stamp)

    def _unix_offset(self) -> int | None:
        """Return the offset (ns) of Unix time from the time since power-up; None if no fix states the date."""
        receivers = [columns for name in RECEIVERS for _, columns in self._topics(name) if "time_utc_usec" in columns]
        times = [(_nanoseconds(columns["time_utc_usec"]), self._boot(columns)) for columns in receivers]
        offsets = np.concatenate([np.empty(0, np.int64), *((unix - boot)[unix > EARLIEST] for unix, boot in times)])
        return int(np.median(offsets)) if offsets.size else None

    def _receiver(self, topic: str, name: str, columns: Columns) -> Iterator[Batch | Remark]:
        place = _receiver_position(columns)
        if place is None:
            return
        self.used.add(topic)
        position, above_sea = place
        known = {"position": position}
        velocity = ("vel_n_m_s", "vel_e_m_s", "vel_d_m_s")
        if set(velocity) <= columns.keys():
            valid = columns.get("vel_ned_valid", np.ones(len(position)))
            known["velocity"] = np.where(valid[:, None] > 0, trajectory.triples(columns, velocity), np.nan)
        if {"eph", "epv"} <= columns.keys():
            known["position_sigma"] = trajectory.sigmas(_positive(columns["eph"]), _positive(columns["epv"]))
        if "s_variance_m_s" in columns:
            sigma = _positive(columns["s_variance_m_s"])
            known["velocity_sigma"] = trajectory.sigmas(sigma, sigma)
        if "fix_type" in columns:
            known["fix_type"] = trajectory.fix_types(columns["fix_type"])
        origin = Origin(f"deg, m{above_sea}, m/s", "NED", self._epoch)
        time = self._boot(columns) + (self._offset or 0)
        yield from trajectory.located(name, "gnss", time, known, origin, self._size)

    def _solution(self) -> Iterator[Batch | Remark]:
        """Yield the navigation solution: position, with velocity and attitude of other topics."""
        local, places = self._topic(LOCAL), self._topic(GLOBAL)
        if places is not None and {"lat", "lon", "alt"} <= places.keys():
            name, source = GLOBAL, places
            position = trajectory.positions(places["lat"], places["lon"], places["alt"])
        elif local is not None and {"ref_lat", "ref_lon", "ref_alt", "x", "y", "z"} <= local.keys():
            name, source, position = LOCAL, local, _local_position(local)
        else:
            return
        rows, boot = trajectory.usable(position), self._boot(source)
        if not rows.any():
            return
        self.used.add(name)
        columns = {"position": position}
        if {"eph", "epv"} <= source.keys():
            sigmas = trajectory.sigmas(_positive(source["eph"]), _positive(source["epv"]))
            columns["position_sigma"] = sigmas
        if local is not None and {"vx", "vy", "vz"} <= local.keys():
            self.used.add(LOCAL)
            columns["velocity"] = trajectory.interpolated(
                boot, self._boot(local), trajectory.triples(local, ("vx", "vy", "vz"))
            )
            if {"evh", "evv"} <= local.keys():
                sigma = trajectory.sigmas(_positive(local["evh"]), _positive(local["evv"]))
                columns["velocity_sigma"] = trajectory.interpolated(boot, self._boot(local), sigma)
        attitude = self._topic(ATTITUDE)
        if attitude is not None and "q" in attitude:
            self.used.add(ATTITUDE)
            with np.errstate(invalid="ignore"):  # damaged numbers may be infinite
                angles = euler_of_quaternion(attitude["q"].astype(float))
            columns |= trajectory.attitudes(boot, self._boot(attitude), angles)
        origin = Origin(f"deg, m{ABOVE_SEA}, m/s", trajectory.ESTIMATED, self._epoch)
        # Rows without a position are normal here: the solution begins before the first fix.
        kept = {key: column[rows] for key, column in columns.items()}
        yield Batch(name, "reference", boot[rows] + (self._offset or 0), kept, origin, self._size, exact=True)


def _nanoseconds(microseconds: NDArray[Any]) -> Nanoseconds:
    return microseconds.clip(0, 2**62 // MICRO).astype(np.int64) * MICRO


def _wide(values: NDArray[Any]) -> NDArray[Any]:
    """Return single precision as double; damaged numbers may be signalling nans, for which numpy warns."""
    with np.errstate(invalid="ignore"):
        return values.astype(np.float64) if values.dtype == np.float32 else values


def _receiver_position(columns: Columns) -> tuple[Floats, str] | None:
    """Return a receiver's positions, and a text on their heights if none above the ellipsoid are logged; None without positions."""
    above_sea = "" if {"altitude_ellipsoid_m", "alt_ellipsoid"} & columns.keys() else ABOVE_SEA
    if {"latitude_deg", "longitude_deg"} <= columns.keys():
        height = columns.get("altitude_ellipsoid_m", columns.get("altitude_msl_m"))
        latitude, longitude, unit = columns["latitude_deg"], columns["longitude_deg"], 1.0
    elif {"lat", "lon"} <= columns.keys():
        height = columns.get("alt_ellipsoid", columns.get("alt"))
        latitude, longitude, unit = columns["lat"] * 1e-7, columns["lon"] * 1e-7, 1e-3
    else:
        return None
    return None if height is None else (trajectory.positions(latitude, longitude, height * unit), above_sea)


def _local_position(local: Columns) -> Floats:
    """Return positions from displacements, (n, 3) m, NED, from a reference point; 0 where the point is unknown."""
    reference = trajectory.positions(local["ref_lat"], local["ref_lon"], local["ref_alt"])
    known = (local.get("xy_global", local["ref_lat"] != 0) > 0) & trajectory.usable(reference)
    position = np.zeros_like(reference)
    position[known] = displaced(reference[known], trajectory.triples(local, "xyz")[known])
    return position


def _positive(values: NDArray[Any]) -> Floats:
    return np.where(values > 0, values, np.nan).astype(float)

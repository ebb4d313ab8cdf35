"""PX4's logs (.ulg): every IMU, its raw samples where they were kept, receivers and the solution."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from imuwb.errors import UnreadableLogError
from imuwb.geodesy import displaced
from imuwb.log import MEAN_SEA_LEVEL, Origin
from imuwb.readers.batch import Batch, Remark
from imuwb.readers.bytes import source
from imuwb.readers.flight.boot_clock import EARLIEST
from imuwb.readers.flight.receiver import attitude_at, left_out, usable_position
from imuwb.readers.flight.ulog_records import MAGIC, ULogFile

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    from imuwb.log import Epoch
    from imuwb.readers.batch import ReadOptions

    Columns = Mapping[str, NDArray[Any]]

format = "ulog"  # noqa: A001 - the contract's name
uses: tuple[str, ...] = ()
COMBINED, INCREMENTS = "sensor_combined", "vehicle_imu"
RECEIVERS = ("sensor_gps", "vehicle_gps_position")
GLOBAL, LOCAL, ATTITUDE = "vehicle_global_position", "vehicle_local_position", "vehicle_attitude"
TRIADS = {"angular_rate": "sensor_gyro", "specific_force": "sensor_accel"}
WANTED = frozenset(
    (
        COMBINED,
        INCREMENTS,
        *RECEIVERS,
        GLOBAL,
        LOCAL,
        ATTITUDE,
        *TRIADS.values(),
        *(f"{n}_fifo" for n in TRIADS.values()),
    )
)
_SHAPES = {"q": (4,), **dict.fromkeys(("gyro_rad", "accelerometer_m_s2", "delta_angle", "delta_velocity"), (3,))}
LONGEST_STEP = 1e6  #: µs between samples of a sensor's own buffer
INVALID = 2**31 - 1  #: of a relative stamp
MICRO = 1000  #: ns
ABOVE_SEA = f" ({MEAN_SEA_LEVEL})"  #: PX4's own solution, and its oldest receivers


def probe(head: bytes) -> bool:
    """Return whether the file begins with ULog's magic."""
    return head.startswith(MAGIC)


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the streams; the file is mapped into memory, not read at once.

    Raises:
        UnreadableLogError: not one whole message.
    """
    del options  # the format says everything itself; it has one clock
    trouble: list[str] = []
    buffer = _bytes(path, trouble)
    log = ULogFile()
    log.take(buffer, WANTED)
    if not log.data:
        message = f"{path}: a PX4 log without a whole message of data"
        raise UnreadableLogError(message)
    yield from (Remark(text) for text in trouble)
    yield from _Streams(log, path.stat().st_size).all()
    if log.dropouts:
        yield Remark(
            f"{len(log.dropouts)} dropouts while writing, {sum(log.dropouts)} ms in all, the longest {max(log.dropouts)} ms"
        )
    faults = {"bytes that are no message": log.skipped, "messages shorter than their topic, not used": log.misfits}
    yield from (Remark(f"{count} {what}") for what, count in faults.items() if count)


def _bytes(path: Path, trouble: list[str]) -> NDArray[np.uint8]:
    with source.open_unpacked(path) as file:
        if source.is_packed(file):
            return np.frombuffer(b"".join(source.pieces(file, trouble)), np.uint8)
    return np.memmap(path, np.uint8, "r")


class _Streams:
    """From topics to batches."""

    def __init__(self, log: ULogFile, size: int) -> None:
        self._log, self._size = log, size
        self._offset = self._unix_offset()
        self._epoch: Epoch = "boot" if self._offset is None else "unix"

    def all(self) -> Iterator[Batch | Remark]:
        """Yield everything there is, the IMU that was sampled most first."""
        imus = [*self._raw(), *self._combined(), *self._increments()]
        rows: dict[str, int] = {}
        for batch in imus:
            rows[batch.stream] = max(rows.get(batch.stream, 0), batch.time.size)
        yield from sorted(imus, key=lambda batch: -rows[batch.stream])
        yield from self._receivers()
        yield from self._solution()
        yield Remark(
            "times count from power-up: no fix tells the date"
            if self._offset is None
            else "times since power-up made UTC by the receiver"
        )

    def _topics(self, name: str) -> list[tuple[str, Columns]]:
        """Return a topic's instances, named by their number where there are several."""
        # A field of another shape than PX4's is another field.
        fifo = name.endswith("_fifo")

        def fits(field: str, values: NDArray[Any]) -> bool:
            return values.ndim == 2 if fifo and field in "xyz" else values.shape[1:] == _SHAPES.get(field, ())  # noqa: PLR2004

        shaped = [(i, {k: _wide(v) for k, v in c.items() if fits(k, v)}) for i, c in self._log.topics(name)]
        found = [(i, columns) for i, columns in shaped if "timestamp" in columns]
        several = len(found) > 1 or any(i for i, _ in found)
        return [(f"{name}.{i}" if several else name, columns) for i, columns in found]

    def _boot(self, columns: Columns) -> NDArray[np.int64]:
        stamp = columns["timestamp"]
        taken = columns.get("timestamp_sample")
        if taken is not None and taken.any():
            stamp = taken
        return stamp.clip(0, 2**62 // MICRO).astype(np.int64) * MICRO

    def _unix_offset(self) -> int | None:
        found: list[NDArray[np.int64]] = []
        for name in RECEIVERS:
            for _, columns in self._topics(name):
                unix = (
                    columns.get("time_utc_usec", np.zeros(1, np.uint64)).clip(0, 2**62 // MICRO).astype(np.int64)
                    * MICRO
                )
                sure = unix > EARLIEST
                if sure.any():
                    found.append((unix - self._boot(columns))[sure])
        return int(np.median(np.concatenate(found))) if found else None

    def _batch(self, name: str, kind: Any, boot: NDArray[np.int64], columns: dict[str, Any], units: str) -> Batch:  # noqa: ANN401 - a Kind
        time = boot + (self._offset or 0)
        frame = "NED" if kind in ("gnss", "reference") else "FRD"
        return Batch(name, kind, time, columns, Origin(units, frame, self._epoch), self._size)

    def _raw(self) -> Iterator[Batch]:
        """Yield the single sensors, gyro and accelerometer of one number as one IMU, each with its own clock."""
        for suffix in ("_fifo", ""):
            triads = {quantity: dict(self._topics(name + suffix)) for quantity, name in TRIADS.items()}
            names = {quantity: {_instance(stream): stream for stream in found} for quantity, found in triads.items()}
            for instance in sorted({i for found in names.values() for i in found}):
                parts = [names[quantity][instance] for quantity in TRIADS if instance in names[quantity]]
                # The accelerometer comes first in the name, as PX4 numbers them.
                imu = "+".join(sorted(parts))
                for quantity, found in triads.items():
                    stream = names[quantity].get(instance)
                    if stream is not None:
                        yield from self._sensor(imu, quantity, found[stream], fifo=bool(suffix))

    def _sensor(self, imu: str, quantity: str, columns: Columns, *, fifo: bool) -> Iterator[Batch]:
        shapes = {columns[axis].shape if axis in columns else () for axis in "xyz"}
        if len(shapes) > 1 or () in shapes:
            return
        boot = self._boot(columns)
        if fifo:
            if not {"samples", "dt", "scale"} <= columns.keys():
                return
            boot, values = _unrolled(boot, columns)
        else:
            values = np.stack([columns[axis].astype(float) for axis in "xyz"], axis=1)
        yield self._batch(imu, "imu", boot, {quantity: values}, "rad/s, m/s²")
        warmth = columns.get("temperature")
        if warmth is not None and quantity == "specific_force" and np.isfinite(warmth).any() and not fifo:
            yield self._batch(imu, "imu", boot, {"temperature": warmth.astype(float)}, "rad/s, m/s²")

    def _combined(self) -> Iterator[Batch]:
        for name, columns in self._topics(COMBINED):
            boot = self._boot(columns)
            if "gyro_rad" in columns:
                yield self._batch(name, "imu", boot, {"angular_rate": columns["gyro_rad"].astype(float)}, "rad/s, m/s²")
            force = columns.get("accelerometer_m_s2")
            if force is None:
                continue
            relative = columns.get("accelerometer_timestamp_relative", np.zeros(boot.size, np.int32))
            there = np.abs(relative.astype(float)) < INVALID  # a damaged definition may make any numbers of them
            relative = np.where(there, relative, 0).astype(np.int64)
            yield self._batch(
                name,
                "imu",
                (boot + relative * MICRO)[there],
                {"specific_force": force[there].astype(float)},
                "rad/s, m/s²",
            )

    def _increments(self) -> Iterator[Batch]:
        for name, columns in self._topics(INCREMENTS):
            for quantity, delta in (("angular_rate", "delta_angle"), ("specific_force", "delta_velocity")):
                if not {delta, f"{delta}_dt"} <= columns.keys():
                    continue
                span = columns[f"{delta}_dt"].astype(float)  # µs; s in the oldest logs
                span = np.where(span > 1, span * 1e-6, span)
                there = span > 0
                values = columns[delta].astype(float)[there] / span[there, None]
                yield self._batch(name, "imu", self._boot(columns)[there], {quantity: values}, "rad, m/s (increments)")

    def _receivers(self) -> Iterator[Batch | Remark]:
        for topic in RECEIVERS:
            for name, columns in self._topics(topic):
                found = _position(columns)
                if found is None:
                    continue
                position, above = found
                there = usable_position(position)
                yield from left_out(name, there)
                if not there.any():
                    continue
                known = {"position": position}
                if {"vel_n_m_s", "vel_e_m_s", "vel_d_m_s"} <= columns.keys():
                    velocity = np.stack([columns[f"vel_{axis}_m_s"].astype(float) for axis in "ned"], axis=1)
                    valid = columns.get("vel_ned_valid", np.ones(len(velocity)))
                    known["velocity"] = np.where(valid[:, None] > 0, velocity, np.nan)
                if {"eph", "epv"} <= columns.keys():
                    known["position_sigma"] = np.stack(
                        [_positive(columns[key]) for key in ("eph", "eph", "epv")], axis=1
                    )
                if "s_variance_m_s" in columns:
                    known["velocity_sigma"] = np.stack([_positive(columns["s_variance_m_s"])] * 3, axis=1)
                if "fix_type" in columns:
                    known["fix_type"] = columns["fix_type"].astype(float)
                kept = {key: column[there] for key, column in known.items()}
                yield self._batch(name, "gnss", self._boot(columns)[there], kept, f"deg, m{above}, m/s")

    def _solution(self) -> Iterator[Batch]:
        """Yield what the flight controller made of it all, with velocity and attitude beside it."""
        local = dict(self._topics(LOCAL)).get(LOCAL)
        places = dict(self._topics(GLOBAL)).get(GLOBAL)
        if places is not None and {"lat", "lon", "alt"} <= places.keys():
            name, boot = GLOBAL, self._boot(places)
            position = np.stack(
                [np.radians(places["lat"]), np.radians(places["lon"]), places["alt"].astype(float)], axis=1
            )
        elif local is not None and {"ref_lat", "ref_lon", "ref_alt", "x", "y", "z"} <= local.keys():
            name, boot = LOCAL, self._boot(local)
            origin = np.stack([np.radians(local["ref_lat"]), np.radians(local["ref_lon"]), local["ref_alt"]], axis=1)
            known = (local.get("xy_global", local["ref_lat"] != 0) > 0) & usable_position(origin)
            position = np.zeros((boot.size, 3))
            moved = np.stack([local[axis].astype(float) for axis in "xyz"], axis=1)[known]
            position[known] = displaced(origin[known].astype(float), moved)
        else:
            return
        there = usable_position(position)
        columns = {"position": position}
        if local is not None and {"vx", "vy", "vz"} <= local.keys():
            at = self._boot(local)
            columns["velocity"] = np.stack([np.interp(boot, at, local[key]) for key in ("vx", "vy", "vz")], axis=1)
        attitude = dict(self._topics(ATTITUDE)).get(ATTITUDE)
        if attitude is not None and "q" in attitude:
            known = np.isfinite(attitude["q"]).all(axis=1)
            if known.any():
                angles = _euler(attitude["q"][known].astype(float))
                columns["attitude"] = attitude_at(boot, self._boot(attitude)[known], angles)
        if there.any():
            kept = {key: column[there] for key, column in columns.items()}
            yield self._batch(name, "reference", boot[there], kept, f"deg, m{ABOVE_SEA}, m/s")


def _wide(values: NDArray[Any]) -> NDArray[Any]:
    """Return single-precision numbers as double; damage makes signalling nans of some, which the processor remarks on."""
    with np.errstate(invalid="ignore"):
        return values.astype(np.float64) if values.dtype == np.float32 else values


def _instance(stream: str) -> int:
    _, _, number = stream.rpartition(".")
    return int(number) if number.isdigit() else 0


def _unrolled(boot: NDArray[np.int64], columns: Columns) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return time and value of each sample of a sensor's own buffer; the last of a message has its stamp."""
    values = np.stack([columns[axis].astype(float) for axis in "xyz"], axis=2)  # message, sample, axis
    step = np.where((columns["dt"] >= 0) & (columns["dt"] < LONGEST_STEP), columns["dt"], np.nan) * MICRO
    count = np.where(np.isfinite(step), columns["samples"].astype(np.int64).clip(0, values.shape[1]), 0)
    step = np.nan_to_num(step)
    place = np.arange(values.shape[1])[None, :]
    there = place < count[:, None]
    time = boot[:, None] - np.rint((count[:, None] - 1 - place) * step[:, None]).astype(np.int64)
    return time[there], (values * columns["scale"].astype(float)[:, None, None])[there]


def _position(columns: Columns) -> tuple[NDArray[np.float64], str] | None:
    """Return latitude, longitude and height; above the ellipsoid where that is told, else with a word on it."""
    above_sea = "" if {"altitude_ellipsoid_m", "alt_ellipsoid"} & columns.keys() else ABOVE_SEA
    if {"latitude_deg", "longitude_deg"} <= columns.keys():
        height = columns.get("altitude_ellipsoid_m", columns.get("altitude_msl_m"))
        scale, above = 1.0, 1.0
        latitude, longitude = columns["latitude_deg"], columns["longitude_deg"]
    elif {"lat", "lon"} <= columns.keys():
        height = columns.get("alt_ellipsoid", columns.get("alt"))
        scale, above = 1e-7, 1e-3
        latitude, longitude = columns["lat"], columns["lon"]
    else:
        return None
    if height is None:
        return None
    position = np.stack([np.radians(latitude * scale), np.radians(longitude * scale), height * above], axis=1)
    return position.astype(float), above_sea


def _positive(values: NDArray[Any]) -> NDArray[np.float64]:
    return np.where(values > 0, values, np.nan).astype(float)


def _euler(q: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return roll, pitch and heading of quaternions, body to NED, scalar first (Groves, eq. 2.37)."""
    w, x, y, z = q.T
    roll = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x**2 + y**2))
    pitch = np.arcsin((2 * (w * y - z * x)).clip(-1, 1))
    return np.stack([roll, pitch, np.arctan2(2 * (w * z + x * y), 1 - 2 * (y**2 + z**2))], axis=1)

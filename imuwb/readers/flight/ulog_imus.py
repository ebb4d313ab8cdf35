"""The IMUs of a PX4 log: single sensors, their own buffers, the combined sensors, and increments.

Sources: PX4, ``msg/SensorGyro.msg``, ``SensorGyroFifo.msg``, ``SensorCombined.msg``, ``VehicleImu.msg``, ``SensorSelection.msg``.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from imuwb.arrays import Floats, Integers
from imuwb.log import Epoch, Nanoseconds, Origin
from imuwb.notes import Note
from imuwb.readers.batch import Batch, Remark
from imuwb.readers.flight import trajectory

Columns = Mapping[str, NDArray[Any]]
Topics = Sequence[tuple[str, Columns]]

COMBINED, INCREMENTS, SELECTION = "sensor_combined", "vehicle_imu", "sensor_selection"
SENSORS = {"angular_rate": "sensor_gyro", "specific_force": "sensor_accel"}
SHORT = {"angular_rate": "gyro", "specific_force": "accel"}
FIFOS = tuple(f"{name}_fifo" for name in SENSORS.values())
LONGEST_STEP = 1e6  #: µs between the samples in a sensor's own buffer; a larger one is damage
INVALID = 2**31 - 1  #: relative stamp of a sample that is not valid
MICRO = 1000  #: ns
CROWDED = (
    0.5  #: steps of a buffer; if a buffer begins so much before its place, its samples are moved together with a note
)
PARTLY = 0.5  #: share of the time between two rows; a sample that is the mean over less is one of several
IMU_UNITS = "rad/s, m/s²"


@dataclass(frozen=True, slots=True)
class PX4Imus:
    """Makes the batches of a log's IMUs."""

    topics: Callable[[str], Topics]  #: name -> the topic's instances, with their names
    boot: Callable[[Columns], Nanoseconds]  #: the time since power-up of a topic's rows
    offset: int  #: ns, Unix time less the time since power-up; 0 if it is unknown
    epoch: Epoch
    size: int  #: bytes of the file
    used: set[str] = field(default_factory=set[str])  #: topics that are used

    def all(self) -> Iterator[Batch | Remark]:
        """Yield the batches of all IMUs, and remarks on their times."""
        yield from self._sensors()
        yield from self._combined()
        yield from self._increments()
        yield Remark("", devices={name: stated for name, stated in self._numbers().items() if stated})

    def _numbers(self) -> dict[str, dict[str, int]]:
        """Return the numbers of the devices of each IMU whose topics state one, the same in all rows."""
        found: dict[str, dict[str, int]] = {}
        for suffix in ("_fifo", ""):
            topics = {quantity: dict(self.topics(name + suffix)) for quantity, name in SENSORS.items()}
            for parts in _devices(topics):
                numbers = {SHORT[quantity]: _device(topics[quantity][name]) for quantity, name in parts.items()}
                found["+".join(sorted(parts.values()))] = numbers
        chosen = [_chosen(columns) for _, columns in self.topics(SELECTION)]
        found |= {name: _chosen(columns) for name, columns in self.topics(INCREMENTS)}
        found |= {name: chosen[0] for name, _ in self.topics(COMBINED) if len(chosen) == 1}
        return {name: {sensor: number for sensor, number in own.items() if number} for name, own in found.items()}

    def _batch(self, name: str, boot: Nanoseconds, quantity: str, values: Floats, units: str = IMU_UNITS) -> Batch:
        origin = Origin(units, "FRD", self.epoch)
        return Batch(name, "imu", boot + self.offset, {quantity: values}, origin, self.size, exact=True)

    def _sensors(self) -> Iterator[Batch | Remark]:
        """Yield the single sensors: a gyro and an accelerometer of one device are one IMU, each with its own clock."""
        for suffix in ("_fifo", ""):
            topics = {quantity: dict(self.topics(name + suffix)) for quantity, name in SENSORS.items()}
            for parts in _devices(topics):
                imu = "+".join(sorted(parts.values()))
                for quantity, name in parts.items():
                    yield from self._sensor(imu, quantity, topics[quantity][name], SENSORS[quantity] + suffix)

    def _sensor(self, imu: str, quantity: str, columns: Columns, topic: str) -> Iterator[Batch | Remark]:
        shapes = {columns[axis].shape if axis in columns else () for axis in "xyz"}
        fifo = topic in FIFOS
        if len(shapes) > 1 or () in shapes or (fifo and not {"samples", "dt", "scale"} <= columns.keys()):
            return
        self.used.add(topic)
        boot = self.boot(columns)
        if fifo:
            time, values, crowded = _unrolled(boot, columns)
            yield self._batch(imu, time, quantity, values)
            if crowded:
                text = "samples of a sensor's buffer closer together than stated: the buffer before had not ended"
                yield Remark(Note("fifo_crowded", text), imu, crowded, "time")
            return
        yield self._batch(imu, boot, quantity, trajectory.triples(columns, "xyz"))
        warmth = _celsius(columns)
        if warmth is not None and quantity == "specific_force":
            yield self._batch(imu, boot, "temperature", warmth)

    def _combined(self) -> Iterator[Batch | Remark]:
        for name, columns in self.topics(COMBINED):
            boot = self.boot(columns)
            yield from _partial(name, boot, columns.get("gyro_integral_dt", columns.get("accelerometer_integral_dt")))
            if "gyro_rad" in columns:
                self.used.add(COMBINED)
                yield self._batch(name, boot, "angular_rate", columns["gyro_rad"].astype(float))
            force = columns.get("accelerometer_m_s2")
            if force is None:
                continue
            self.used.add(COMBINED)
            relative = columns.get("accelerometer_timestamp_relative", np.zeros(boot.size, np.int32))
            valid = np.abs(relative.astype(float)) < INVALID  # with a damaged definition these may be any numbers
            time = boot + np.where(valid, relative, 0).astype(np.int64) * MICRO
            yield self._batch(name, time[valid], "specific_force", force[valid].astype(float))
            yield from self._selected_temperature(name)

    def _selected_temperature(self, name: str) -> Iterator[Batch | Remark]:
        """Yield the temperature of the accelerometer that the combined sensors are taken from, if it is always the same."""
        chosen = {
            int(device) for _, c in self.topics(SELECTION) for device in c.get("accel_device_id", np.empty(0, int))
        } - {0}
        for topic, columns in self.topics(SENSORS["specific_force"]):
            warmth = _celsius(columns)
            if len(chosen) == 1 and _device(columns) in chosen and warmth is not None:
                self.used.add(SELECTION)
                yield self._batch(name, self.boot(columns), "temperature", warmth)
                text = f"{name}: its temperature is that of {topic}, from which {SELECTION} says it is taken"
                yield Remark(Note("temperature_of_selected", text))
                return

    def _increments(self) -> Iterator[Batch | Remark]:
        """Yield increments of angle and velocity as the mean rates over their spans."""
        for name, columns in self.topics(INCREMENTS):
            for quantity, delta in (("angular_rate", "delta_angle"), ("specific_force", "delta_velocity")):
                if not {delta, f"{delta}_dt"} <= columns.keys():
                    continue
                self.used.add(INCREMENTS)
                span = columns[f"{delta}_dt"].astype(float)  # µs, but s in the oldest logs
                span = np.where(span > 1, span * 1e-6, span)
                rows = span > 0
                boot = self.boot(columns)[rows]
                values = columns[delta].astype(float)[rows] / span[rows, None]
                yield self._batch(name, boot, quantity, values, "rad, m/s (increments)")
                if quantity == "angular_rate":
                    yield from _partial(name, boot, span[rows] * 1e6)


def _devices(topics: Mapping[str, Mapping[str, Columns]]) -> Iterator[dict[str, str]]:
    """Yield {quantity: topic} of each IMU: sensors with one device number, else with one instance number."""
    names = {quantity: list(streams) for quantity, streams in topics.items()}
    gyros, accels = names["angular_rate"], names["specific_force"]
    devices = {name: _device(columns) for streams in topics.values() for name, columns in streams.items()}
    pairs = [(g, a) for g in gyros for a in accels if devices[g] and devices[g] == devices[a]]
    free = [a for a in accels if a not in {accel for _, accel in pairs}]
    pairs += [
        (g, a) for g in gyros if g not in {gyro for gyro, _ in pairs} for a in free if _instance(g) == _instance(a)
    ]
    paired = {name for pair in pairs for name in pair}
    found = [{"angular_rate": g, "specific_force": a} for g, a in pairs]
    found += [{quantity: name} for quantity, own in names.items() for name in own if name not in paired]
    yield from sorted(found, key=lambda parts: min(map(_instance, parts.values())))


def _chosen(columns: Columns) -> dict[str, int]:
    """Return the numbers of the gyro and the accelerometer that a topic of both states."""
    return {sensor: _device(columns, f"{sensor}_device_id") for sensor in SHORT.values()}


def _device(columns: Columns, key: str = "device_id") -> int:
    """Return the number of the device that a topic's rows are from; 0 if there is none, or several."""
    numbers = np.unique(columns.get(key, np.zeros(1, int)))
    return int(numbers[0]) if numbers.size == 1 else 0


def _instance(stream: str) -> int:
    _, _, number = stream.rpartition(".")
    return int(number) if number.isdigit() else 0


def _celsius(columns: Columns) -> Floats | None:
    """Return the temperature that a topic states; None if it states none."""
    warmth = columns.get("temperature")
    return None if warmth is None or not np.isfinite(warmth).any() else warmth.astype(float)


def _partial(name: str, boot: Nanoseconds, span: NDArray[Any] | None) -> Iterator[Remark]:
    """Yield a remark if the samples are means over much less time than lies between the rows: most samples were not logged."""
    if span is None or boot.size < 2:  # noqa: PLR2004 - a step
        return
    step, own = float(np.median(np.diff(boot))) / MICRO, float(np.median(span.astype(float)))
    own = own * 1e6 if 0 < own < 1 else own  # s in the oldest logs
    if 0 < own < PARTLY * step:
        text = (
            f"{name}: each sample is the mean over {own / 1000:.3g} ms, and the rows are {step / 1000:.3g} ms apart: about one of "
            f"{step / own:.0f} samples was logged, and noise above half the log's rate is folded below it"
        )
        yield Remark(Note("partial_samples", text))


def _unrolled(boot: Nanoseconds, columns: Columns) -> tuple[Nanoseconds, Floats, int]:
    """Return time and values of the samples in a sensor's own buffer, and how many were moved together.

    The stamp of a message is that of its last sample; the others come before it in steps of ``dt``. A buffer whose first
    sample would not be after the last of the buffer before fills the time since then evenly.
    """
    values = np.stack([columns[axis].astype(float) for axis in "xyz"], axis=2)  # message, sample, axis
    step = np.where((columns["dt"] >= 0) & (columns["dt"] < LONGEST_STEP), columns["dt"], np.nan) * MICRO
    count = np.where(np.isfinite(step), columns["samples"].astype(np.int64).clip(0, values.shape[1]), 0)
    filled = count > 0
    values = (values * columns["scale"].astype(float)[:, None, None])[filled]
    boot, step, count = boot[filled], step[filled], count[filled]
    room = np.diff(boot, prepend=boot[:1]).astype(float) / count
    tight = (room > 0) & (room < step)
    crowded = tight & (count * (step - room) > CROWDED * step)
    step = np.where(tight, room, step)
    sample: Integers = np.arange(values.shape[1])[None, :]
    used = sample < count[:, None]
    time = boot[:, None] - np.rint((count[:, None] - 1 - sample) * step[:, None]).astype(np.int64)
    return time[used], values[used], int(count[crowded].sum())

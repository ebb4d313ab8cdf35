"""IMU messages of which only one half is a sensor: the other half is 0 throughout, or its covariance states that there is none.

Cameras with an IMU publish a gyroscope and an accelerometer as two topics of ``sensor_msgs/Imu``, at rates of their own. Some put
both on one topic, where messages of either kind take turns.
"""

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from imuwb.arrays import Booleans, Floats
from imuwb.notes import Note
from imuwb.readers.batch import Batch, Remark
from imuwb.readers.containers.message_columns import NONE

FEWEST = 20  #: rows; fewer rows of 0 are taken as measured
SENSORS = {"angular_rate": "gyroscope", "specific_force": "accelerometer"}


class Halves:
    """Parts the batches of one IMU into sensors, if its first messages show that one half may be none."""

    def __init__(self) -> None:
        """No message is seen yet."""
        self._apart: bool | None = None  #: whether sensors come in batches of their own
        self._held: dict[str, list[Batch]] = {
            name: [] for name in SENSORS
        }  #: rows that are 0 so far, without the zeros
        self._seen: set[str] = set()  #: sensors with a row that is not 0
        self._absent: Counter[str] = Counter()  #: rows whose covariance states that there is no such sensor

    def parted(self, batch: Batch, sensors: tuple[str, ...]) -> Iterator[Batch]:
        """Yield a batch, or the rows of each of its sensors.

        Args:
            batch: of an IMU; rows of a sensor that a message lacks are ``NONE``.
            sensors: columns that the messages may have.
        """
        if self._apart is None:
            whole = all(name in batch.columns and batch.columns[name].any() for name in sensors)
            self._apart = not whole or any(_lacking(batch.columns[name]).any() for name in sensors)
        if not self._apart:
            yield batch
            return
        for name, values in batch.columns.items():
            if name not in SENSORS:
                yield replace(batch, columns={name: values})
                continue
            there = ~_lacking(values)
            self._absent[name] += int(np.count_nonzero(~there))
            if not there.any():
                continue
            rows = _taken(batch, name, there)
            if name not in self._seen and not rows.columns[name].any():
                self._held[name].append(replace(rows, columns={}))
                continue
            self._seen.add(name)
            yield from self._released(name)
            yield rows
        for name in set(sensors) - batch.columns.keys():
            self._absent[name] += batch.time.size

    def rest(self) -> Iterator[Batch]:
        """Yield the rows of a sensor that are 0, if they are too few to tell."""
        for name in SENSORS:
            if self._zeros(name) < FEWEST:
                yield from self._released(name)

    def _released(self, name: str) -> Iterator[Batch]:
        """Yield the rows that are 0 before the first row that is not."""
        for rows in self._held[name]:
            yield replace(rows, columns={name: np.zeros((rows.time.size, 3))})
        self._held[name].clear()

    def _zeros(self, name: str) -> int:
        return sum(rows.time.size for rows in self._held[name])

    def remarks(self, name: str) -> Iterator[Remark]:
        """Yield what is no sensor."""
        for column, sensor in SENSORS.items():
            zeros = self._zeros(column)
            if zeros:
                text = f"{name}: its {sensor} is 0 in all {zeros} messages, so it is taken as no sensor"
                yield Remark(Note("no_sensor", text))
            elif self._absent[column] and column not in self._seen:
                text = f"{name}: no {sensor}: the covariance of all {self._absent[column]} messages states that there is none"
                yield Remark(Note("no_sensor", text))


def _lacking(values: Floats) -> Booleans:
    """Return which messages lack a body vector."""
    return (values == NONE).all(axis=1)


def _taken(batch: Batch, name: str, rows: Booleans) -> Batch:
    if rows.all():
        return replace(batch, columns={name: batch.columns[name]})
    return replace(batch, time=batch.time[rows], columns={name: batch.columns[name][rows]})

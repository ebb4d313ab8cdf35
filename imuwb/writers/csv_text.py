"""CSV with unit-bearing names; numbers in full, so that reading gives back every bit."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa
from pyarrow import csv

from imuwb.errors import MissingDataError
from imuwb.writers.beside import beside

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from imuwb.log import ImuStream, Log

ROWS = 1 << 16


def write_csv(log: Log, path: Path, progress: Callable[[int, int], None] | None = None) -> None:
    """Write the log's one IMU: time, rates, specific forces, and the temperature in the rows that have one.

    Raises:
        MissingDataError: not exactly one IMU, or triads on two clocks; one table has room for one clock.
    """
    others = len(log.gnss) + len(log.speeds) + len(log.references)
    if len(log.imus) != 1 or others:
        message = f"a CSV file holds one IMU; this log has {len(log.imus)}, and {others} other streams"
        raise MissingDataError(message)
    imu = log.imus[0]
    table = _table(imu)
    with beside(path) as temporary, temporary.open("wb") as file:
        file.write((",".join(table.column_names) + "\n").encode())
        options = csv.WriteOptions(include_header=False, quoting_style="none")
        for start in range(0, table.num_rows, ROWS):
            csv.write_csv(table.slice(start, ROWS), file, options)
            if progress is not None:
                progress(min(start + ROWS, table.num_rows), table.num_rows)


def _table(imu: ImuStream) -> pa.Table:
    triads = {"gyro_{}_rad_s": imu.angular_rate, "accel_{}_m_s2": imu.specific_force}
    there = {name: triad for name, triad in triads.items() if triad is not None}
    time = next(iter(there.values())).time
    columns: dict[str, Any] = {"time_ns": time}
    for name, triad in there.items():
        if not np.array_equal(triad.time, time):
            message = f"{imu.name}: gyro and accelerometer have clocks of their own; one CSV table has room for one"
            raise MissingDataError(message)
        for column, axis in enumerate("xyz"):
            columns[name.format(axis)] = np.ascontiguousarray(triad.value[:, column])
    if imu.temperature is not None:
        place = np.searchsorted(time, imu.temperature.time).clip(0, time.size - 1)
        cells = np.full(time.size, np.nan)
        cells[place] = imu.temperature.value
        columns["temperature_c"] = pa.array(cells, from_pandas=True)
    return pa.table(columns)

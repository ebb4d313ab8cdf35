"""CSV with units in the column names, and numbers with all digits, so that a reader gets exactly the same numbers.

Each table has a sidecar, which the reader uses; it states the body frame, and the epoch that times count from.
"""

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from pyarrow import csv

from imuwb.arrays import Floats
from imuwb.errors import MissingDataError
from imuwb.log import GnssStream, ImuStream, Log, Reference, Scalars
from imuwb.progress import Progress
from imuwb.sidecars import MARK, mark_of, sidecar_beside
from imuwb.writers.whole import together, whole_file, write_text

ROWS = 1 << 16
_WAYS = ("north", "east", "down")


def places(log: Log, path: Path) -> tuple[Path, ...]:
    """Return the files that a log becomes: the tables, and the sidecar of each."""
    return tuple(file for table in _tables(log, path).values() for file in (table, sidecar_beside(table)))


def _tables(log: Log, path: Path) -> dict[str, Path]:
    """Return {kind: table}: the first kind has ``path``, the others have the kind in their name."""
    kinds = {"imu": log.imus, "gnss": log.gnss, "speed": log.speeds, "reference": log.references}
    there = [kind for kind, streams in kinds.items() if streams]
    return {kind: path if kind == there[0] else path.with_name(f"{path.stem}.{kind}.csv") for kind in there}


def write_csv(log: Log, path: Path, progress: Progress | None = None) -> None:
    """Write the log's IMU, receiver, speed and reference, each to a table of its own with a sidecar.

    Raises:
        MissingDataError: more than one stream of a kind, or triads on two clocks: a table has one clock.
    """
    kinds = {"imu": log.imus, "gnss": log.gnss, "speed": log.speeds, "reference": log.references}
    several = {kind: [s.name for s in streams] for kind, streams in kinds.items() if len(streams) > 1}
    if several:
        what = "; ".join(f"{kind}: {', '.join(names)}" for kind, names in several.items())
        raise MissingDataError(
            f"{path}: a CSV table has one stream of a kind, and this log has more ({what}); choose an IMU with --imu, or write .mcap"
        )
    made = [
        *map(_table, log.imus), *map(_gnss_table, log.gnss),
        *(pa.table({"time_ns": speed.time, "speed_m_s": speed.value}) for speed in log.speeds),
        *map(_reference_table, log.references),
    ]  # fmt: skip
    rows = sum(table.num_rows for table in made)
    done = 0
    truth = "".join(
        f"{json.dumps(name)} = {json.dumps(value, ensure_ascii=False)}\n" for name, value in log.truth.items()
    )
    truth = f"\n[simulated]\n{truth}" if truth else ""
    epochs = [stream.origin.epoch for stream in (*log.imus, *log.gnss, *log.references)]
    with together(places(log, path)):
        for (kind, place), table in zip(_tables(log, path).items(), made, strict=True):
            # A speed has no origin of its own: its clock is that of the other streams.
            origins = [stream.origin.epoch for stream in kinds[kind] if not isinstance(stream, Scalars)]
            epoch = (*origins, *epochs, "log")[0]
            frame = 'frame = "FRD"\n' if kind == "imu" else ""
            for written in _written(table, place, f'{frame}epoch = "{epoch}"\n{truth}'):
                if progress is not None:
                    progress(done + written, rows)
            done += table.num_rows


def _written(table: pa.Table, place: Path, stated: str) -> Iterator[int]:
    """Write a table and the sidecar that states its frame and epoch; yield the number of rows that are written, piece by piece."""
    with whole_file(place) as temporary:
        with temporary.open("wb") as file:
            file.write((",".join(table.column_names) + "\n").encode())
            options = csv.WriteOptions(include_header=False, quoting_style="none")
            for start in range(0, table.num_rows, ROWS):
                csv.write_csv(table.slice(start, ROWS), file, options)
                yield min(start + ROWS, table.num_rows)
        mark = mark_of(temporary)
    head = f"# What {place.name} does not state itself. Delete the next line if the table has changed and the rest is still true.\n"
    write_text(sidecar_beside(place), f'{head}{MARK} = "{mark}"\n{stated}')


def write_reference(reference: Reference, more: Mapping[str, Floats], path: Path) -> None:
    """Write a reference to a table with more columns, {name: (n,)}, and its sidecar; nan becomes an empty cell."""
    table = _reference_table(reference)
    for name, values in more.items():
        table = table.append_column(name, pa.array(values, from_pandas=True))
    with together((path, sidecar_beside(path))):
        for _ in _written(table, path, f'epoch = "{reference.origin.epoch}"\n'):
            pass


def _gnss_table(gnss: GnssStream) -> pa.Table:
    columns: dict[str, Any] = {"time_ns": gnss.time, **_position(gnss)}
    for values, name in (
        (gnss.velocity, "velocity_{}_m_s"), (gnss.position_sigma, "sigma_{}_m"), (gnss.velocity_sigma, "sigma_velocity_{}_m_s"),
    ):  # fmt: skip
        if values is not None:
            columns |= {name.format(way): pa.array(values[:, i], from_pandas=True) for i, way in enumerate(_WAYS)}
    if gnss.fix_type is not None:
        # 0, an unknown type, is an empty cell, because readers take 0 as no fix.
        columns["fix_type"] = pa.array(gnss.fix_type, mask=gnss.fix_type == 0)
    return pa.table(columns)


def _reference_table(reference: Reference) -> pa.Table:
    columns: dict[str, Any] = {"time_ns": reference.time, **_position(reference)}
    if reference.velocity is not None:
        columns |= {f"velocity_{way}_m_s": reference.velocity[:, i] for i, way in enumerate(_WAYS)}
    unknown = np.full((reference.time.size, 3), np.nan)
    attitude = unknown if reference.attitude is None else reference.attitude
    columns |= {
        f"{angle}_rad": pa.array(attitude[:, i], from_pandas=True)
        for i, angle in enumerate(("roll", "pitch", "heading"))
    }
    for values, name in (
        (reference.position_sigma, "sigma_{}_m"), (reference.velocity_sigma, "sigma_velocity_{}_m_s"),
        (reference.attitude_sigma, "sigma_attitude_{}_rad"),
    ):  # fmt: skip
        if values is not None:
            columns |= {name.format(way): pa.array(values[:, i], from_pandas=True) for i, way in enumerate(_WAYS)}
    return pa.table(columns)


def _position(stream: GnssStream | Reference) -> dict[str, Any]:
    latitude, longitude, height = stream.position.T
    name = "height_msl_m" if stream.origin.above_sea else "height_m"
    return {"latitude_rad": latitude, "longitude_rad": longitude, name: np.ascontiguousarray(height)}


def _table(imu: ImuStream) -> pa.Table:
    triads = {"gyro_{}_rad_s": imu.angular_rate, "accel_{}_m_s2": imu.specific_force}
    there = {name: triad for name, triad in triads.items() if triad is not None}
    time = next(iter(there.values())).time
    columns: dict[str, Any] = {"time_ns": time}
    for name, triad in there.items():
        if not np.array_equal(triad.time, time):
            raise MissingDataError(
                f"{imu.name}: gyro and accelerometer have different clocks, and a CSV table has one; write .mcap"
            )
        for axis in triad.axes:
            column = "xyz".index(axis)
            columns[name.format(axis)] = np.ascontiguousarray(triad.value[:, column])
    if imu.temperature is not None:
        place = np.searchsorted(time, imu.temperature.time).clip(0, time.size - 1)
        cells = np.full(time.size, np.nan)
        cells[place] = imu.temperature.value
        columns["temperature_c"] = pa.array(cells, from_pandas=True)
    return pa.table(columns)

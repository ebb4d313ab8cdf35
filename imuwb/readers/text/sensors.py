"""The sensors and topics whose columns stand in one text log."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from imuwb.arrays import Booleans, Floats
from imuwb.readers.text.column_names import Column

Values = Mapping[Column, Floats]
Sensor = tuple[str, Booleans | None, Values]  #: name, rows (None: all), and columns

#: quantities that a sensor is recognised by
_MAIN = ("gyro", "accel", "latitude")


def is_sparse(rows: Sequence[Sequence[str]], used: Sequence[Column]) -> bool:
    """Return whether some of the first rows have cells of other sensors alone: rows of several topics in one table."""
    for quantity in _MAIN:
        places = {column.index for column in used if column.quantity == quantity}
        if any(all(_is_empty(row[i]) for i in places) for row in rows) and any(
            not all(_is_empty(row[i]) for i in places) for row in rows
        ):
            others = [i for i in range(len(rows[0])) if i not in places and _varies(rows, i, places)]
            if places and others:
                return True
    return False


def _is_empty(cell: str) -> bool:
    return cell.strip().lower() in ("", "nan", "null", "none")


def _varies(rows: Sequence[Sequence[str]], place: int, places: set[int]) -> bool:
    """Return whether a cell is filled in rows without the cells of some places, and empty in a row that has them."""
    without = any(not _is_empty(row[place]) for row in rows if all(_is_empty(row[i]) for i in places))
    return without and any(_is_empty(row[place]) for row in rows if not all(_is_empty(row[i]) for i in places))


def sensors_of(values: Values) -> Iterator[Sensor]:
    """Yield the name of each sensor, its rows (None: all), and its columns; a log of one sensor has no name for it."""
    instance = next((column for column in values if column.quantity == "instance"), None)
    if instance is not None:
        rest = {column: cells for column, cells in values.items() if column is not instance}
        numbers = values[instance]
        for number in np.unique(numbers[np.isfinite(numbers)]):
            yield f"{number:g}", numbers == number, rest
        return
    names = list(dict.fromkeys(column.stream for column in values if column.quantity in _MAIN))
    if all(len({c.stream for c in values if c.quantity == quantity}) <= 1 for quantity in _MAIN):
        yield "", None, values  # a gyro and an accelerometer with different names are one IMU
        return
    for name in names:
        part = {column: cells for column, cells in values.items() if column.stream == name}
        yield name, None, part


def stream_name(kind: str, sensor: str) -> str:
    """Return the name of a stream: its kind if the log has one sensor, else the name of the sensor."""
    return kind + sensor if not sensor or sensor.isdigit() else sensor

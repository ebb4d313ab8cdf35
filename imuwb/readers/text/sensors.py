"""The sensors and topics whose columns stand in one text log."""

from collections.abc import Iterator, Mapping

import numpy as np

from imuwb.arrays import Booleans, Floats
from imuwb.readers.text.column_names import Column

Values = Mapping[Column, Floats]
Sensor = tuple[str, Booleans | None, Values]  #: name, rows (None: all), and columns

#: quantities that a sensor is recognised by
_MAIN = ("gyro", "accel", "latitude")


def sensors_of(values: Values, *, sparse: bool) -> Iterator[Sensor]:
    """Yield the name of each sensor, its rows (None: all), and its columns; a log of one sensor has no name for it.

    Args:
        values: cells of each column.
        sparse: whether a row has the cells of some sensors alone.
    """
    instance = next((column for column in values if column.quantity == "instance"), None)
    if instance is not None:
        rest = {column: cells for column, cells in values.items() if column is not instance}
        numbers = values[instance]
        for number in np.unique(numbers[np.isfinite(numbers)]):
            yield f"{number:g}", numbers == number, rest
        return
    names = list(dict.fromkeys(column.stream for column in values if column.quantity in _MAIN))
    if not sparse and max(map(len, (_with(values, ("gyro", "accel")), _with(values, ("latitude",))))) <= 1:
        yield "", None, values
        return
    for name in names:
        part = {column: cells for column, cells in values.items() if column.stream == name}
        rows = np.any([np.isfinite(cells) for cells in part.values()], axis=0) if sparse else None
        yield name if len(names) > 1 else "", rows, part


def stream_name(kind: str, sensor: str) -> str:
    """Return the name of a stream: its kind if the log has one sensor, else the name of the sensor."""
    return kind + sensor if not sensor or sensor.isdigit() else sensor


def _with(values: Values, quantities: tuple[str, ...]) -> set[str]:
    return {column.stream for column in values if column.quantity in quantities}

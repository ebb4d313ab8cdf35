"""The columns of a text log that are used, each with its unit."""

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from statistics import median

import numpy as np

from imuwb.arrays import Floats
from imuwb.errors import UnreadableLogError, UsageError
from imuwb.readers.quantities import DIMENSIONS, units_by_quantity
from imuwb.readers.read_options import ReadOptions
from imuwb.readers.text.column_names import Column, columns
from imuwb.readers.text.increments import RATES
from imuwb.readers.text.layout import Layout
from imuwb.readers.text.shapes.application import Shaped
from imuwb.readers.text.trust import is_number
from imuwb.units import STANDARD_GRAVITY, UNITS, unit

#: dimension -> unit of a column without a stated unit; an IMU's unit must be stated, because several are common
_USUAL = {"temperature": "°C", "angle": "deg", "length": "m", "speed": "m/s"}
STILL = 0.1  #: largest relative difference between the specific force at rest and standard gravity
WRONG = 2.0  #: factor between the specific force and one gravity, beyond which the stated unit is doubtful
LEAST_FORCE = 0.5  #: a smaller |f| is one gravity in no unit
DAMAGED = 1e9  #: a larger number is damage, whatever its unit


def used_columns(path: Path, layout: Layout, options: ReadOptions, shape: Shaped | None = None) -> tuple[Column, ...]:
    """Return the columns that are used, each with its unit.

    Raises:
        UsageError: names or units of the columns are unknown.
        UnreadableLogError: the log has nothing but columns that are refused, such as an acceleration without gravity.
    """
    if shape is not None:
        if shape.refused and not any(column.quantity not in ("time", "week") for column in shape.columns):
            names, why = ", ".join(shape.refused), next(iter(shape.refused.values()))
            raise UnreadableLogError(f"{path}: nothing can be used ({shape.shape.name}): {names}: {why}")
        return tuple(_with_unit(path, column, shape.columns, layout) for column in shape.columns)
    names = options.columns or layout.names
    if not names:
        raise UsageError(
            f"{path}: there is no header line; name the {len(layout.first)} columns, for example "
            "--columns gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z (- for a column that is not used)"
        )
    if len(names) != len(layout.first):
        raise UsageError(
            f"{path}: there are {len(names)} column names ({', '.join(names)}), but the rows have {len(layout.first)} cells; "
            "name each column with --columns"
        )
    known = columns(names, units_by_quantity(options.units))
    return tuple(_with_unit(path, column, known, layout) for column in known)


def _with_unit(path: Path, column: Column, known: tuple[Column, ...], layout: Layout) -> Column:
    """Return a column with its unit, stated or usual; that of a time column is found later."""
    if column.unit is not None or column.quantity == "time":
        return column
    usual = _USUAL.get(DIMENSIONS[column.quantity])
    if usual is not None and column.quantity not in RATES:
        return replace(column, unit=unit(usual))
    group = [other for other in known if other.quantity == column.quantity]
    hint = {"attitude_increment": "rad or deg", "velocity_increment": "m/s"}.get(column.quantity, "deg/s or rad/s")
    if column.quantity == "accel":
        hint = _force_hint(group, layout)
    names = ", ".join(other.name for other in group)
    raise UsageError(f"{path}: the unit of {names} is unknown ({hint}); state it: --units {column.quantity}=UNIT")


def _force_hint(group: Sequence[Column], layout: Layout) -> str:
    """Return what the size of the first rows' specific force says about its unit."""
    rows = [[row[other.index] for other in group] for row in layout.sample or (layout.first,)]
    norms = [math.hypot(*map(float, cells)) for cells in rows if all(map(_is_small, cells))]
    norm = median(norms) if norms else 0.0
    likely = _likely(norm)
    if likely is None and 0 < norm < LEAST_FORCE:
        return f"|f| is {norm:.4g}, one gravity in no unit; an acceleration without gravity, or an increment, is no specific force"
    return f"|f| is {norm:.4g}, so likely {likely or 'g or m/s²'}"


def check_gravity(path: Path, force: Floats, used: tuple[Column, ...]) -> bool:
    """Return whether there are samples to check.

    Raises:
        UnreadableLogError: the samples are one gravity in another unit than the stated one.
    """
    stated = next(column.unit for column in used if column.quantity == "accel")
    sound = force[np.isfinite(force).all(axis=1) & (np.abs(force) < DAMAGED).all(axis=1)]
    if not sound.size:
        return False
    norm = float(np.median(np.linalg.norm(sound, axis=1)))
    if stated is None or STANDARD_GRAVITY / WRONG < norm < WRONG * STANDARD_GRAVITY:
        return True
    likely = _likely(norm / stated.factor)
    if likely is not None:
        raise UnreadableLogError(
            f"{path}: accel is stated in {stated.name}, but |f| is {norm / stated.factor:.4g}; an accelerometer at rest "
            f"measures one gravity, so the unit is likely {likely}: --units accel={likely}"
        )
    return True


def _is_small(cell: str) -> bool:
    return is_number(cell) and abs(float(cell)) < DAMAGED  # nan is not below it


def _likely(norm: float) -> str | None:
    """Return the unit in which a specific force is about one gravity; None if no unit fits."""
    ratios = {name: norm * UNITS[name].factor / STANDARD_GRAVITY for name in ("m/s²", "g", "mg")}
    return next((name for name, ratio in ratios.items() if abs(ratio - 1) < STILL), None)

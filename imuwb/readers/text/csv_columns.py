"""The columns of a text log that are used, each with its unit."""

from dataclasses import replace
from pathlib import Path

from imuwb.errors import UnreadableLogError, UsageError
from imuwb.readers.quantities import DIMENSIONS, units_by_quantity
from imuwb.readers.read_options import ReadOptions
from imuwb.readers.text.column_names import Column, columns
from imuwb.readers.text.gravity import hint
from imuwb.readers.text.increments import RATES
from imuwb.readers.text.layout import Layout
from imuwb.readers.text.left_out import recognised
from imuwb.readers.text.shapes.application import Shaped
from imuwb.readers.text.stamps import stamps_of
from imuwb.readers.text.trust import is_number
from imuwb.units import unit

#: dimension -> unit of a column without a stated unit; an IMU's unit must be stated, because several are common
_USUAL = {"temperature": "°C", "angle": "deg", "length": "m", "speed": "m/s"}


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
        return _complete(path, shape.columns, layout, options)
    names = options.columns or layout.names
    if not names:
        raise UsageError(
            f"{path}: there is no header line; name the {len(layout.first)} columns, for example "
            f"--columns {_example(len(layout.first))} (- for a column that is not used"
            + ("; tag for the column that tells its sensors apart)" if layout.tag is not None else ")")
        )
    if len(names) != len(layout.first):
        raise UsageError(
            f"{path}: there are {len(names)} column names ({', '.join(names)}), but the rows have {len(layout.first)} cells; "
            "name each column with --columns"
        )
    known = columns(names, units_by_quantity(options.units))
    _refuse_mixed_counts(path, known, layout)
    return _complete(path, known, layout, options)


def _example(count: int) -> str:
    """Return names for so many columns, which can be typed as they are."""
    axes = [f"{sensor}_{axis}" for sensor in ("gyro", "accel") for axis in "xyz"]
    names = axes if count in (3, 6) else ["time", *axes]
    return ",".join([*names, *["-"] * count][:count])


def _complete(path: Path, known: tuple[Column, ...], layout: Layout, options: ReadOptions) -> tuple[Column, ...]:
    """Return columns with their units, stated or usual; that of a time column is found later.

    Raises:
        UsageError: the unit of an IMU's column is unknown; the message says all that is missing.
    """
    complete = tuple(map(_with_usual_unit, known))
    lacking = list(dict.fromkeys(c.quantity for c in complete if c.unit is None and c.quantity != "time"))
    if not lacking:
        return complete
    asked = ", and of ".join(_asked(quantity, complete, layout) for quantity in lacking)
    untimed = not options.rate and not any(c.quantity == "time" for c in known) and not stamps_of(layout.names, layout)
    rate = "; there is no time column either: state --rate HZ" if untimed else ""
    units = ",".join(f"{quantity}=UNIT" for quantity in lacking)
    raise UsageError(
        f"{path}: the unit of {asked} is unknown; state {'it' if len(lacking) == 1 else 'them'}: --units {units}{rate}"
        f"{recognised(options.columns or layout.names, complete)}"
    )


def _with_usual_unit(column: Column) -> Column:
    usual = _USUAL.get(DIMENSIONS[column.quantity])
    if column.unit is not None or usual is None or column.quantity in ("time", *RATES):
        return column
    return replace(column, unit=unit(usual))


def _asked(quantity: str, known: tuple[Column, ...], layout: Layout) -> str:
    """Return the columns whose unit is asked for, and what their numbers show of it."""
    group = [other for other in known if other.quantity == quantity]
    hints = {"attitude_increment": "rad or deg", "velocity_increment": "m/s"}
    rows = [[row[other.index] for other in group] for row in layout.sample or (layout.first,)]
    return f"{', '.join(other.name for other in group)} ({hints.get(quantity) or hint(quantity, rows)})"


def _refuse_mixed_counts(path: Path, used: tuple[Column, ...], layout: Layout) -> None:
    """Refuse a temperature of whole numbers without a unit beside sensors in counts: it is likely in counts too.

    Raises:
        UsageError: there is such a column.
    """
    if not any(column.unit is not None and "lsb" in column.unit.name.lower() for column in used):
        return
    for column in used:
        cells = [cell for cell in layout.cells(column.index) if is_number(cell)]
        if column.quantity == "temperature" and column.unit is None and cells and all(map(_is_whole, cells)):
            raise UsageError(
                f"{path}: column {column.name!r} has whole numbers beside sensors in counts, so likely counts too; state its scale and "
                "offset: --units temperature=340LSB/C+36.53 (the MPU-6050's), or temperature=°C"
            )


def _is_whole(cell: str) -> bool:
    return cell.lstrip("+-").isdigit()

"""What a text log has that is not used, named with the reason."""

from collections.abc import Collection, Iterator, Mapping, Sequence

from imuwb.notes import Note
from imuwb.readers.batch import Remark, unused
from imuwb.readers.quantities import DIMENSIONS
from imuwb.readers.text.column_names import Column
from imuwb.readers.text.shapes.application import Shaped

#: field of a stream -> the quantities that make it up
_FIELDS: Mapping[str, tuple[str, ...]] = {
    "angular_rate": ("gyro", "attitude_increment", "step"), "specific_force": ("accel", "velocity_increment", "step"),
    "temperature": ("temperature",), "speed": ("speed",), "fix_type": ("fix_type",),
    "position": ("latitude", "longitude", "height", "height_msl", "undulation"),
    "velocity": ("velocity_north", "velocity_east", "velocity_down", "velocity_up", "ground_speed", "course"),
    "position_sigma": ("sigma_north", "sigma_east", "sigma_down", "sigma_horizontal", "sigma_vertical"),
    "velocity_sigma": ("sigma_velocity_north", "sigma_velocity_east", "sigma_velocity_down", "sigma_speed"),
    "attitude": ("roll", "pitch", "heading"),
    "attitude_sigma": ("sigma_attitude_north", "sigma_attitude_east", "sigma_attitude_down"),
}  # fmt: skip
_ROWS = ("time", "week", "instance", "counter")  #: quantities of the rows themselves
UNKNOWN = "no quantity that imuwb knows by these names; --columns can name them"


def unused_columns(names: Sequence[str], used: Collection[Column], shape: Shaped | None) -> Iterator[Remark]:
    """Yield a remark on the columns that are not used, and one for each other reason that the shape of the log gives."""
    refused = {} if shape is None else shape.refused
    for why in dict.fromkeys(refused.values()):
        yield unused((name for name, reason in refused.items() if reason == why), why)
    taken = {column.index for column in used}
    rest = [n for i, n in enumerate(names) if i not in taken and n and n != "-" and n not in refused]
    if rest and any(column.quantity not in _ROWS for column in used):
        yield unused(rest, UNKNOWN)


def left_over(used: Collection[Column], fields: Collection[str]) -> Iterator[Remark]:
    """Yield a remark on the known columns of which no stream was made."""
    quantities = {quantity for field in fields for quantity in _FIELDS.get(field, ())}
    rest = [c.name for c in used if c.quantity in DIMENSIONS and c.quantity not in (*quantities, *_ROWS)]
    if rest:
        yield unused(rest, "the columns that make a stream with them are missing")


def no_stream(names: Sequence[str], used: Collection[Column]) -> Note:
    """Return the note that nothing in a log can be used: what is missing, and what its columns were taken for."""
    quantities = {column.quantity for column in used}
    missing = "axes of a gyro or an accelerometer, or a latitude and a longitude"
    if "latitude" in quantities or "longitude" in quantities:
        missing = "a longitude" if "latitude" in quantities else "a latitude"
    text = f"no stream in this file: it lacks {missing}{recognised(names, used)}"
    return Note("no_stream", f"{text}; name the columns with --columns")


def recognised(names: Sequence[str], used: Collection[Column]) -> str:
    """Return what the columns of a log were taken for, and which were not recognised, as the end of a sentence."""
    known = {column.index for column in used}
    taken = ", ".join(f"{c.name} ({c.quantity.replace('_', ' ')})" for c in used) or "none that is known"
    others = ", ".join(n for i, n in enumerate(names) if i not in known and n and n != "-")
    return f"; known columns: {taken}" + (f"; not recognised: {others}" if others else "")

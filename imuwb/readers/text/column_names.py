"""The quantity and the unit that a text file's column name states: ``gyro_x_deg_s``, ``ax [g]``, ``wx(rad/s)``."""

import re
from collections.abc import Mapping
from dataclasses import dataclass

from imuwb.errors import ImuwbError, UsageError
from imuwb.readers.quantities import DIMENSIONS
from imuwb.units import Unit, unit

_AXIS = r"[_ .\[]*([xyz])\]?"
#: quantity -> pattern of its column names, in lower case and without the unit
_NAMES: dict[str, str] = {
    "gyro": rf"(?:imu[_ .])?(?:gyro(?:scope)?s?|gyr|g|omega|w|ang(?:ular)?[_ .]?(?:vel(?:ocity)?|rate)){_AXIS}",
    "accel": rf"(?:imu[_ .])?(?:accel(?:erometer|eration)?s?|acc|a|f|sf|specific[_ .]?force"
    rf"|lin(?:ear)?[_ .]?acc(?:el(?:eration)?)?){_AXIS}",
    "time": r"t|gpst|time|timestamp|time[_ .]?stamp|stamp|t[_ ].*|time[_ ].*|.*[_ ]time|seconds?|utc|unix.*|(?:gps[_ .]?)?(?:tow|sow)|gps[_ .]?(?:s|sec|seconds?)"
    r"|(?:seconds?|time)[_ ]of[_ ](?:the[_ ])?week",
    "temperature": r"temp(?:erature)?|t[_ ]?imu|imu[_ .]temp(?:erature)?",
    "latitude": r"(?:gnss[_ .]|gps[_ .])?lat(?:itude)?",
    "longitude": r"(?:gnss[_ .]|gps[_ .])?(?:lon|lng|long|longitude)",
    "height": r"(?:gnss[_ .]|gps[_ .])?(?:h|hgt|height|alt|altitude|ellipsoidal[_ ]height)(?:[_ .]?a?msl)?|a?msl",
    "velocity_north": r"vn|v_?north|(?:gnss[_ .])?velocity[_ .]north",
    "velocity_east": r"ve|v_?east|(?:gnss[_ .])?velocity[_ .]east",
    "velocity_down": r"vd|v_?down|(?:gnss[_ .])?velocity[_ .]down",
    "velocity_up": r"vu|v_?up|(?:gnss[_ .])?velocity[_ .]up",
    "sigma_north": r"(?:position[_ ])?(?:sigma|std|sd)[_ .]?n(?:orth)?",
    "sigma_east": r"(?:position[_ ])?(?:sigma|std|sd)[_ .]?e(?:ast)?",
    "sigma_down": r"(?:position[_ ])?(?:sigma|std|sd)[_ .]?d(?:own)?",
    "sigma_velocity_north": r"(?:velocity[_ ]sigma|sigma[_ ]velocity)[_ .]?n(?:orth)?",
    "sigma_velocity_east": r"(?:velocity[_ ]sigma|sigma[_ ]velocity)[_ .]?e(?:ast)?",
    "sigma_velocity_down": r"(?:velocity[_ ]sigma|sigma[_ ]velocity)[_ .]?d(?:own)?",
    "sigma_attitude_north": r"sigma[_ ]attitude[_ ]north", "sigma_attitude_east": r"sigma[_ ]attitude[_ ]east",
    "sigma_attitude_down": r"sigma[_ ]attitude[_ ]down",
    "fix_type": r"fix(?:[_ ]?type)?",
    "speed": r"(?:wheel[_ .]|odo(?:meter)?[_ .]|vehicle[_ .]|forward[_ .])?speed|odometer",
    "roll": r"roll", "pitch": r"pitch", "heading": r"heading|yaw",
    "week": r"(?:gps[_ .]?)?week(?:[_ ]?(?:no|number))?",
}  # fmt: skip
_ABOVE_SEA = re.compile(r"(?:^|[^a-z])(?:height|alt)?a?msl(?:[^a-z]|$)")
_OF_WEEK = re.compile(r"tow|sow|of[_ ](?:the[_ ])?week|gps")
#: end of a name -> unit, for names without brackets
_SUFFIXES = {
    "deg_s": "deg/s", "degs": "deg/s", "dps": "deg/s", "deg_per_s": "deg/s", "rad_s": "rad/s", "rads": "rad/s",
    "rad_per_s": "rad/s", "mrad_s": "mrad/s", "deg_h": "deg/h", "m_s2": "m/s²", "m_s_2": "m/s²", "ms2": "m/s²",
    "mps2": "m/s²", "m_per_s2": "m/s²", "mg": "mg", "g": "g", "s": "s", "sec": "s", "ms": "ms", "us": "us",
    "ns": "ns", "c": "°C", "degc": "°C", "deg_c": "°C", "k": "K", "degf": "°F", "deg_f": "°F", "f": "°F", "deg": "deg", "rad": "rad", "m": "m", "mm": "mm",
    "m_s": "m/s", "mps": "m/s", "dege7": "degE7",
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Column:
    """One column that is used."""

    index: int
    name: str  #: name in the file
    quantity: str  #: a key of DIMENSIONS
    axis: int  #: 0, 1, 2 for x, y, z; 0 for a quantity without axes
    unit: Unit | None  #: None: unknown


def above_sea(column: Column) -> bool:
    """Return whether a column's name states heights above mean sea level."""
    return column.quantity == "height" and _ABOVE_SEA.search(column.name.lower()) is not None


def scale_of(column: Column) -> str | None:
    """Return the time scale that a column's name states, ``"UTC"`` or ``"GPS"``; None if it states none."""
    parts = set(re.split(r"[^a-z0-9]+", column.name.lower()))
    return "UTC" if "utc" in parts else "GPS" if parts & {"gps", "gpst"} else None


def columns(names: tuple[str, ...], units: Mapping[str, str]) -> tuple[Column, ...]:
    """Return the columns with a known quantity.

    Args:
        names: names of all columns, in order.
        units: {quantity: unit}; they override the units in the names.

    Raises:
        UsageError: two columns have the same quantity and axis.
    """
    known = [column for i, name in enumerate(names) if (column := _column(i, name, units)) is not None]
    first: dict[tuple[str, int], Column] = {}
    # With a GPS week, the time of week is preferred to any other time.
    weeks = any(column.quantity == "week" for column in known)
    for column in sorted(known, key=lambda c: weeks and c.quantity == "time" and not _OF_WEEK.search(c.name.lower())):
        other = first.setdefault((column.quantity, column.axis), column)
        if other is not column and column.quantity != "time":
            raise UsageError(
                f"columns {other.name!r} and {column.name!r} are both {column.quantity}; name the columns with --columns"
            )
    return tuple(first.values())


def _column(index: int, name: str, units: Mapping[str, str]) -> Column | None:
    """Return the column of a name; None for an unknown quantity."""
    base, stated = _parted(name)
    for quantity, pattern in _NAMES.items():
        for text in dict.fromkeys((base, name.strip().lower())):
            match = re.fullmatch(pattern, text)
            if match is None:
                continue
            axis = "xyz".index(match[1]) if match.lastindex else 0
            # The end of a name such as "g_x" or "vd" may look like a unit: then the whole name matches, without a unit.
            measure = unit(units[quantity]) if quantity in units else stated if text == base else None
            if quantity in ("fix_type", "week"):
                measure = unit("1")
            if measure is None or measure.dimension == DIMENSIONS[quantity]:
                return Column(index, name, quantity, axis, measure)
    return None


def _parted(name: str) -> tuple[str, Unit | None]:
    """Return a column's name without its unit, and the unit; None if the name has no known unit."""
    text = name.strip()
    bracketed = re.fullmatch(r"(.+?)\s*[\[(]\s*([^\])]+?)\s*[\])]", text)
    if bracketed and bracketed[2].lower() not in "xyz":
        try:
            return bracketed[1].strip().lower(), unit(bracketed[2])
        except ImuwbError:
            return bracketed[1].strip().lower(), None
    text = text.lower()
    for suffix in sorted(_SUFFIXES, key=len, reverse=True):
        if text.endswith(f"_{suffix}") and len(text) > len(suffix) + 1:
            return text[: -len(suffix) - 1], unit(_SUFFIXES[suffix])
    return text, None

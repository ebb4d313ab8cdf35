"""What a text file's column names mean, and in which unit: ``gyro_x_deg_s``, ``ax [g]``, ``wx(rad/s)``."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from imuwb.errors import ImuwbError, UsageError
from imuwb.units import Unit, unit

if TYPE_CHECKING:
    from collections.abc import Mapping

_AXIS = r"[_ .\[]*([xyz])\]?"
#: quantity -> what its columns are called, lower case, unit taken off
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
    "sigma_north": r"(?:position[_ ])?(?:sigma|std|sd)[_ .]?n(?:orth)?",
    "sigma_east": r"(?:position[_ ])?(?:sigma|std|sd)[_ .]?e(?:ast)?",
    "sigma_down": r"(?:position[_ ])?(?:sigma|std|sd)[_ .]?d(?:own)?",
    "sigma_velocity_north": r"(?:velocity[_ ]sigma|sigma[_ ]velocity)[_ .]?n(?:orth)?",
    "sigma_velocity_east": r"(?:velocity[_ ]sigma|sigma[_ ]velocity)[_ .]?e(?:ast)?",
    "sigma_velocity_down": r"(?:velocity[_ ]sigma|sigma[_ ]velocity)[_ .]?d(?:own)?",
    "fix_type": r"fix(?:[_ ]?type)?",
    "speed": r"(?:wheel[_ .]|odo(?:meter)?[_ .]|vehicle[_ .]|forward[_ .])?speed|odometer",
    "roll": r"roll", "pitch": r"pitch", "heading": r"heading|yaw",
    "week": r"(?:gps[_ .]?)?week(?:[_ ]?(?:no|number))?",
}  # fmt: skip
_ABOVE_SEA = re.compile(r"(?:^|[^a-z])(?:height|alt)?a?msl(?:[^a-z]|$)")
_OF_WEEK = re.compile(r"tow|sow|of[_ ](?:the[_ ])?week|gps")
#: quantity -> the dimension its unit must have
DIMENSIONS = {
    "gyro": "angular_rate", "accel": "specific_force", "time": "time", "temperature": "temperature",
    "latitude": "angle", "longitude": "angle", "height": "length", "velocity_north": "speed",
    "velocity_east": "speed", "velocity_down": "speed", "sigma_north": "length", "sigma_east": "length",
    "sigma_down": "length", "fix_type": "dimensionless", "sigma_velocity_north": "speed", "sigma_velocity_east": "speed",
    "sigma_velocity_down": "speed", "speed": "speed", "roll": "angle", "pitch": "angle", "heading": "angle",
    "week": "dimensionless",
}  # fmt: skip
#: How units end a name, where brackets are not used.
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
    name: str  #: as the file has it
    quantity: str  #: a key of DIMENSIONS
    axis: int  #: 0, 1, 2 for x, y, z; 0 where there is no axis
    unit: Unit | None  #: None: nobody has said it


def above_sea(column: Column) -> bool:
    """Return whether a column is a height above mean sea level, as its name says."""
    return column.quantity == "height" and _ABOVE_SEA.search(column.name.lower()) is not None


def scale_of(column: Column) -> str | None:
    """Return which time scale a column's name says that it counts on: ``"UTC"``, ``"GPS"``; None where it says none."""
    words = set(re.split(r"[^a-z0-9]+", column.name.lower()))
    return "UTC" if "utc" in words else "GPS" if words & {"gps", "gpst"} else None


def columns(names: tuple[str, ...], said: dict[str, str]) -> tuple[Column, ...]:
    """Return the columns that have a meaning, with the unit of ``said`` before that of the name.

    Raises:
        UsageError: a unit that measures something else, or two columns of one meaning.
    """
    found = [column for i, name in enumerate(names) if (column := _column(i, name, said)) is not None]
    seen: dict[tuple[str, int], Column] = {}
    weeks = any(column.quantity == "week" for column in found)
    for column in sorted(found, key=lambda c: weeks and c.quantity == "time" and not _OF_WEEK.search(c.name.lower())):
        other = seen.setdefault((column.quantity, column.axis), column)
        if other is not column and column.quantity != "time":
            message = (
                f"columns {other.name!r} and {column.name!r} both mean {column.quantity}; name them with --columns"
            )
            raise UsageError(message)
    return tuple(seen.values())


def _column(index: int, name: str, said: dict[str, str]) -> Column | None:
    base, written = _parted(name)
    for quantity, pattern in _NAMES.items():
        for text in dict.fromkeys((base, name.strip().lower())):
            match = re.fullmatch(pattern, text)
            if match is None:
                continue
            axis = "xyz".index(match[1]) if match.lastindex else 0
            # A name such as "g_x" or "vd" has no unit; "gyro_x" with suffix "x" neither.
            found = written if text == base else None
            chosen = unit(said[quantity]) if quantity in said else found
            if quantity in ("fix_type", "week"):
                chosen = unit("1")
            if chosen is not None and chosen.dimension != DIMENSIONS[quantity]:
                if quantity not in said:
                    continue
                message = f"{said[quantity]!r} is no unit of {DIMENSIONS[quantity].replace('_', ' ')} (column {name!r})"
                raise UsageError(message)
            return Column(index, name, quantity, axis, chosen)
    return None


def _parted(name: str) -> tuple[str, Unit | None]:
    """Return a column's name without its unit, and the unit."""
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


def check_units(texts: Mapping[str, str]) -> None:
    """Raise UsageError unless each quantity is one that text may hold, and its unit measures it."""
    for quantity, text in said_units(dict(texts)).items():
        if unit(text).dimension != DIMENSIONS[quantity]:
            message = f"{text!r} is no unit of {DIMENSIONS[quantity].replace('_', ' ')} ({quantity})"
            raise UsageError(message)


def said_units(texts: dict[str, str]) -> dict[str, str]:
    """Return units by quantity, ``position`` and ``velocity`` spread over their columns.

    Raises:
        UsageError: no such quantity.
    """
    spread = {
        "position": ("latitude", "longitude"), "velocity": ("velocity_north", "velocity_east", "velocity_down"),
    }  # fmt: skip
    units: dict[str, str] = {}
    for quantity, text in texts.items():
        for name in spread.get(quantity, (quantity,)):
            if name not in DIMENSIONS:
                known = ", ".join((*DIMENSIONS, *spread))
                message = f"no quantity {quantity!r} to give a unit to; there are: {known}"
                raise UsageError(message)
            units[name] = text
    return units

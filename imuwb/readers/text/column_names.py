"""The quantity and the unit that a text file's column name states: ``gyro_x_deg_s``, ``ax [g]``, ``/imu/angular_velocity/x``."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from imuwb.errors import ImuwbError, UsageError
from imuwb.readers.quantities import DIMENSIONS, measures
from imuwb.units import Unit, unit

_DATA = r"(?:[_ .]?(?:readings?|data|meas(?:urements?)?))?"
_GYRO = rf"gyro(?:scope|skop)?s?{_DATA}|giroscopio|drehrate|winkelgeschwindigkeit|velocidad[_ ]angular|vitesse[_ ]angulaire|rate|gyr|omega|ω|ang(?:ular)?[_ .]?(?:vel(?:ocity)?|rate)|rotation[_ .]?rate"
_ACCEL = rf"beschleunigung|aceleraci[oó]n|acc[eé]l[eé]ration|accelerazione|accel(?:erometer|eration)?s?{_DATA}|acc|specific[_ .]?force|lin(?:ear)?[_ .]?acc(?:el(?:eration)?)?"
_VARIANT = r"(?:(?P<variant>raw|uncal(?:ibrated)?|uncomp(?:ensated)?)[_ .]?)?"
_AXIS = r"(?P<number>\d*)[_ .:(\[-]*(?P<axis>[xyz])[\])]?(?:[_ .]?(?P<kind>raw|uncal|cal(?:ibrated)?|filt(?:ered)?))?(?:[_ ](?P<place>\d))?"
_FIRST = r"(?P<first>[xyz])[_ .]*"
#: quantity -> pattern of its column names, in lower case and without the unit
_NAMES: dict[str, str] = {
    "gyro": rf"(?:imu[_ .])?{_VARIANT}(?:(?:{_GYRO}|g|w){_AXIS}|{_FIRST}(?:{_GYRO}))",
    "accel": rf"(?:imu[_ .])?{_VARIANT}(?:(?:{_ACCEL}|a|f|sf){_AXIS}|{_FIRST}(?:{_ACCEL}))",
    "attitude_increment": rf"(?:(?:d(?:elta)?|δ)[_ .]?(?:theta|θ|ang(?:le)?)|attitude[_ ]increment){_AXIS}",
    "velocity_increment": rf"(?:(?:d(?:elta)?|δ)[_ .]?(?:vel(?:ocity)?|v)|velocity[_ ]increment){_AXIS}",
    "time": r"t|gpst|time|timestamp|time[_ .]?stamp|stamp|t[_ ].*|time[_ ].*|.*[_ ]time|seconds?|utc|unix.*|(?:gps[_ .]?)?(?:tow|sow)|gps[_ .]?(?:s|sec|seconds?)"
    r"|(?:seconds?|time)[_ ]of[_ ](?:the[_ ])?week|(?:.+\.)?header\.stamp",
    "temperature": r"temp(?:erature)?|t[_ ]?imu|imu[_ .]temp(?:erature)?",
    "latitude": r"(?:gnss[_ .]|gps[_ .])?lat(?:itude)?",
    "longitude": r"(?:gnss[_ .]|gps[_ .])?(?:lon|lng|long|longitude)",
    "height": r"(?:gnss[_ .]|gps[_ .])?(?:h|hgt|height|alt|altitude|ellipsoidal[_ ]height)(?:[_ .]?a?msl)?|a?msl",
    "velocity_north": r"vn|v_?north|(?:gnss[_ .])?vel(?:ocity)?[_ .](?:north|n)",
    "velocity_east": r"ve|v_?east|(?:gnss[_ .])?vel(?:ocity)?[_ .](?:east|e)",
    "velocity_down": r"vd|v_?down|(?:gnss[_ .])?vel(?:ocity)?[_ .](?:down|d)",
    "velocity_up": r"vu|v_?up|(?:gnss[_ .])?vel(?:ocity)?[_ .](?:up|u)",
    "sigma_north": r"(?:position[_ ])?(?:sigma|std|sd)[_ .]?n(?:orth)?",
    "sigma_east": r"(?:position[_ ])?(?:sigma|std|sd)[_ .]?e(?:ast)?",
    "sigma_down": r"(?:position[_ ])?(?:sigma|std|sd)[_ .]?d(?:own)?",
    "sigma_velocity_north": r"(?:velocity[_ ]sigma|sigma[_ ]velocity)[_ .]?n(?:orth)?",
    "sigma_velocity_east": r"(?:velocity[_ ]sigma|sigma[_ ]velocity)[_ .]?e(?:ast)?",
    "sigma_velocity_down": r"(?:velocity[_ ]sigma|sigma[_ ]velocity)[_ .]?d(?:own)?",
    "sigma_attitude_north": r"sigma[_ ]attitude[_ ]north", "sigma_attitude_east": r"sigma[_ ]attitude[_ ]east",
    "sigma_attitude_down": r"sigma[_ ]attitude[_ ]down",
    "fix_type": r"fix(?:[_ ]?type)?",
    "speed": r"(?:wheel[_ .]|odo(?:meter)?[_ .]|vehicle[_ .]|forward[_ .])?speed|(?:wheel|odo(?:meter)?)[_ .]velocity|odometer",
    "ground_speed": r"ground[_ .]?speed|sog|speed[_ .]?over[_ .]?ground|(?:gps|gnss)[_ .]?(?:ground[_ .]?)?speed",
    "course": r"(?:gps[_ .]|gnss[_ .])?course(?:[_ .]?over[_ .]?ground)?|cog|track[_ .]?angle",
    "sigma_horizontal": r"h(?:orizontal)?[_ .]?acc(?:uracy)?", "sigma_vertical": r"v(?:ertical)?[_ .]?acc(?:uracy)?",
    "sigma_speed": r"s(?:peed)?[_ .]?acc(?:uracy)?",
    "roll": r"roll", "pitch": r"pitch", "heading": r"heading|yaw",
    "week": r"(?:gps[_ .]?)?week(?:[_ ]?(?:no|number))?",
}  # fmt: skip
_PATTERNS = {quantity: re.compile(pattern) for quantity, pattern in _NAMES.items()}
#: quantities whose name may have the name of a sensor or topic before it
_NESTED = ("gyro", "accel", "temperature", "latitude", "longitude", "height")
#: a sensor's whole name, which may also have a word and an underscore before it
_WORDS = re.compile(rf"(?P<prefix>\w+?)_(?P<rest>(?:{_GYRO}|{_ACCEL}){_AXIS})")
_TRIADS = ("attitude_increment", "velocity_increment")  #: quantities that are known only with all three axes
#: words before a quantity that make it another one: a bias, a deviation, an acceleration without gravity
_OTHERS = re.compile(
    r"free|user|dynamic|gravity|world|earth|bias|std|sigma|cov|var|err|offset|scale|noise|cmd|command|setpoint|desired|target|delta|mag"
)
_LINEAR = re.compile(r"(?:.*[/.])?lin(?:ear)?[_ .]?acc", re.IGNORECASE)
_ABOVE_SEA = re.compile(r"(?:^|[^a-z])(?:height|alt)?a?msl(?:[^a-z]|$)")
_OF_WEEK = re.compile(r"tow|sow|of[_ ](?:the[_ ])?week|gps")
_SEPARATORS = re.compile(r"[/.:\s\[\]]+")
#: end of a name -> unit, for names without brackets
_SUFFIXES = {
    "deg_s": "deg/s", "degs": "deg/s", "dps": "deg/s", "deg_per_s": "deg/s", "rad_s": "rad/s", "rads": "rad/s",
    "rad_per_s": "rad/s", "rad_per_sec": "rad/s", "deg_per_sec": "deg/s", "radps": "rad/s", "rad_sec": "rad/s", "deg_sec": "deg/s", "mrad_s": "mrad/s", "deg_h": "deg/h", "m_s2": "m/s²", "m_s_2": "m/s²", "ms2": "m/s²",
    "mps2": "m/s²", "m_per_s2": "m/s²", "mg": "mg", "ug": "µg", "mgal": "mGal", "g": "g", "s": "s", "sec": "s", "ms": "ms", "us": "us", "msec": "ms", "usec": "us", "nsec": "ns",
    "ns": "ns", "c": "°C", "degc": "°C", "deg_c": "°C", "k": "K", "degf": "°F", "deg_f": "°F", "f": "°F", "deg": "deg", "rad": "rad", "m": "m", "mm": "mm",
    "m_s": "m/s", "mm_s": "mm/s", "cm_s": "cm/s", "mps": "m/s", "dege7": "degE7", "mdps": "mdeg/s", "arcsec_s": "arcsec/s", "kmh": "km/h", "knots": "knot",
}  # fmt: skip
_LONGEST_FIRST = sorted(_SUFFIXES, key=len, reverse=True)
#: a name whose axis is a number, perhaps with a unit after it
_NUMBERED = re.compile(
    r"(?P<base>.*?(?:[A-Za-z]|\d(?=[_ .\[(])))[_ .\[(]*(?P<number>[0-3])[\])]?(?P<rest>(?:[ _]?[\[(].*[\])])?)"
)
_INNER = re.compile(rf"(.+?)_({'|'.join(_LONGEST_FIRST)})_([xyz])")  #: a unit between the quantity and the axis
_JOINED = re.compile(r"(.+?)(Mps2|RadPerSec|DegPerSec|Nanos|Millis)")  #: a unit that only a capital letter shows
_JOINED_UNITS = {"Mps2": "m/s²", "RadPerSec": "rad/s", "DegPerSec": "deg/s", "Nanos": "ns", "Millis": "ms"}


@dataclass(frozen=True, slots=True)
class Column:
    """One column that is used."""

    index: int
    name: str  #: name in the file
    quantity: str  #: a key of DIMENSIONS
    axis: int  #: 0, 1, 2 for x, y, z; 0 for a quantity without axes
    unit: Unit | None  #: None: unknown
    stream: str = ""  #: name of the sensor or topic that stands before the quantity; empty in most files
    sign: int = 1  #: -1: the column has the quantity with the other sign


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
        UsageError: two columns of one sensor have the same quantity and axis.
    """
    lettered = _with_letters(names)
    known = [
        replace(column, name=name)
        for i, name in enumerate(names)
        if (column := _column(i, lettered.get(name, name), units)) is not None
    ]
    known = _without_linear(_along_course(known))
    known = [column for column in known if column.quantity not in _TRIADS or _is_whole(column, known)]
    first: dict[tuple[str, str, int], Column] = {}
    # With a GPS week, the time of week is preferred to any other time.
    weeks = any(column.quantity == "week" for column in known)
    for column in sorted(known, key=lambda c: weeks and c.quantity == "time" and not _OF_WEEK.search(c.name.lower())):
        other = first.setdefault((column.stream, column.quantity, column.axis), column)
        if other is not column and column.quantity != "time":
            raise UsageError(
                f"columns {other.name!r} and {column.name!r} are both {column.quantity}; name the columns with --columns"
            )
    return tuple(first.values())


def _along_course(known: Sequence[Column]) -> list[Column]:
    """Return columns of which a speed beside a course and positions is a receiver's over ground."""
    quantities = {column.quantity for column in known}
    if not {"course", "latitude", "speed"} <= quantities or "ground_speed" in quantities:
        return list(known)
    return [replace(c, quantity="ground_speed") if c.quantity == "speed" else c for c in known]


def _without_linear(known: Sequence[Column]) -> list[Column]:
    """Return columns without the linear accelerations, which lack gravity, of a sensor that has another acceleration too."""
    linear = {c.index for c in known if c.quantity == "accel" and _LINEAR.match(c.name.strip())}
    whole = {(c.stream, c.axis) for c in known if c.quantity == "accel" and c.index not in linear}
    return [c for c in known if c.index not in linear or (c.stream, c.axis) not in whole]


def _is_whole(column: Column, known: Sequence[Column]) -> bool:
    """Return whether all three axes of a column's sensor are there."""
    axes = {other.axis for other in known if (other.stream, other.quantity) == (column.stream, column.quantity)}
    return len(axes) == 3  # noqa: PLR2004 - x, y and z


def _with_letters(names: Sequence[str]) -> dict[str, str]:
    """Return names whose axes have numbers with letters: ``gyro_1``, ``gyro_2`` and ``gyro_3``, or 0 to 2, if all three are there."""
    found: dict[tuple[str, str], dict[str, str]] = {}
    for name in names:
        if match := _NUMBERED.fullmatch(name.strip()):
            found.setdefault((match["base"], match["rest"]), {})[match["number"]] = name
    turns = {p: name for name in names if (p := _base_of_rate(name))}
    letters = {
        turns[p]: f"gyro_{axis}{turns[p].strip()[1:]}"
        for p, axis in zip("pqr", "xyz", strict=True)
        if len(turns) == len("pqr")
    }
    return letters | {
        name: f"{base}_{'xyz'[place]}{rest}"
        for (base, rest), axes in found.items()
        if "".join(sorted(axes)) in ("123", "012")
        for place, (_, name) in enumerate(sorted(axes.items()))
    }


def _base_of_rate(name: str) -> str:
    """Return p, q or r for a name that is this letter and a unit of angular rate: rates about x, y and z; else an empty text."""
    for base, measure in with_units(name):
        if measure is not None and measure.dimension == DIMENSIONS["gyro"] and base.lower() in ("p", "q", "r"):
            return base.lower()
    return ""


def parts_of(name: str) -> tuple[str, ...]:
    """Return the parts of a column's name in lower case, without brackets and separators: ``("imu", "gyro", "x")``."""
    return tuple(part for part in _SEPARATORS.split(name.strip().strip('"').lower()) if part)


def before(name: str, count: int) -> str:
    """Return the text of a name's first parts, as the file has it."""
    ends = [match.end() for match in re.finditer(r"[^/.:\s\[\]]+", name)]
    return name[: ends[count - 1]].strip() if count else ""


def with_units(name: str) -> Iterator[tuple[str, Unit | None]]:
    """Yield the ways to read a name: without the unit at its end and the unit, and last as it is, without a unit."""
    text = name.strip()
    bracketed = re.fullmatch(r"(.+?)\s*[\[(]\s*([^\])]*?)\s*[\])]\s*", text)
    if bracketed and not re.fullmatch(r"[xyz]|\d+", bracketed[2].lower()):
        yield bracketed[1].strip(), _unit_or_none(bracketed[2])
    elif joined := _JOINED.fullmatch(text):
        yield joined[1], unit(_JOINED_UNITS[joined[2]])
    else:
        low = text.lower()
        for suffix in _LONGEST_FIRST:
            if low.endswith(f"_{suffix}") and len(text) > len(suffix) + 1:
                yield text[: -len(suffix) - 1], unit(_SUFFIXES[suffix])
                break
        base, _, last = text.rpartition(" ")
        measure = _unit_or_none(last) if base else None
        if measure is not None and last.lower() not in "xyz":
            yield base.strip().removesuffix(" in").rstrip(","), measure
        if inner := _INNER.fullmatch(low):
            yield f"{text[: inner.start(2) - 1]}_{inner[3]}", unit(_SUFFIXES[inner[2]])
    yield text, None


def _unit_or_none(text: str) -> Unit | None:
    try:
        return unit(text) if text else None
    except ImuwbError:
        return None


def _column(index: int, name: str, units: Mapping[str, str]) -> Column | None:
    """Return the column of a name; None for an unknown quantity."""
    ways = tuple(with_units(name))
    for quantity in _PATTERNS:
        for text, stated in ways:
            found = _matched(quantity, text)
            if found is None:
                continue
            stream, axis = found
            # The end of a name such as "g_x" or "vd" may look like a unit: then the whole name matches, without a unit.
            measure = unit(units[quantity]) if quantity in units else stated
            if quantity in ("fix_type", "week"):
                measure = unit("1")
            if measure is None or measures(measure, quantity):
                return Column(index, name, quantity, axis, measure, stream)
    return None


def _matched(quantity: str, text: str) -> tuple[str, int] | None:
    """Return the sensor before a quantity's name, and the axis; None if the text is no name of the quantity."""
    low = text.strip().strip('"').lower()
    if match := _PATTERNS[quantity].fullmatch(low):
        return _place("", match)
    if quantity not in _NESTED:
        return None
    parts = parts_of(text)
    for count in range(1, len(parts)):
        if match := _PATTERNS[quantity].fullmatch(".".join(parts[count:])):
            prefix = before(text, count)
            return None if _OTHERS.search(prefix.lower()) else _place(prefix, match)
    if (match := _WORDS.fullmatch(low)) and not _OTHERS.search(match["prefix"]):
        inner = _PATTERNS[quantity].fullmatch(match["rest"])
        return _place(text.strip()[: len(match["prefix"])], inner) if inner else None
    return None


def _place(prefix: str, match: re.Match[str]) -> tuple[str, int]:
    found = match.groupdict()
    axis = found.get("axis") or found.get("first")
    sensor = "".join(found.get(part) or "" for part in ("variant", "kind", "number", "place"))
    return ".".join(filter(None, (prefix, sensor))), "xyz".index(axis) if axis else 0

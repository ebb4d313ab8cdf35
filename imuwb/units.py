"""Display units and SI: one table converts both ways. All values inside imuwb are SI.

A unit has a name, a dimension, and the factor that converts its values to SI. Spectral and random-walk units look alike but
differ in dimension: ``deg/√h`` is a white-noise density (N), ``deg/h`` a rate (B), ``deg/h^1.5`` a random-walk coefficient (K).
"""

import math
import re
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Literal

from imuwb.errors import UsageError

SECOND = 1_000_000_000  # ns
UNIX_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
#: The start of a log's time: 1970 UTC, the sensor's power-up, or the log's own start.
Epoch = Literal["unix", "boot", "log"]
STANDARD_GRAVITY = 9.80665  # m/s², the "g" of data sheets (CGPM 1901); local gravity differs from it

_DEG = math.pi / 180
_H = 3600.0
_ROOT_H = 60.0
_G = STANDARD_GRAVITY


@dataclass(frozen=True, slots=True)
class Unit:
    """A display unit: ``value_in_si = factor * value + offset``."""

    name: str
    dimension: str
    factor: float
    offset: float = 0.0

    def to_si(self, value: float) -> float:
        """Convert a value in this unit to SI."""
        return value * self.factor + self.offset

    def from_si(self, value: float) -> float:
        """Convert a value in SI to this unit."""
        return (value - self.offset) / self.factor


SENSORS = ("gyro", "accel")  #: of an IMU; their samples may be counts
COUNT = "count"  #: unit of samples without a scale
#: dimension -> {unit: factor to SI}; the first unit of a dimension is its SI unit.
_TABLE: dict[str, dict[str, float]] = {
    "counts": {COUNT: 1},
    "time": {"s": 1, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60, "h": _H},
    "frequency": {"Hz": 1, "kHz": 1e3},
    "length": {"m": 1, "cm": 1e-2, "mm": 1e-3, "km": 1e3, "ft": 0.3048},
    "angle": {"rad": 1, "mrad": 1e-3, "deg": _DEG, "arcsec": _DEG / _H, "degE7": _DEG * 1e-7},
    "speed": {
        "m/s": 1, "km/h": 1 / 3.6, "cm/s": 1e-2, "mm/s": 1e-3, "knot": 1852 / _H, "ft/s": 0.3048, "mph": 1609.344 / _H,
        "g·s": _G, "mg·s": _G * 1e-3, "µg·s": _G * 1e-6,
    },
    "angular_rate": {
        "rad/s": 1, "mrad/s": 1e-3, "µrad/s": 1e-6, "deg/s": _DEG, "mdeg/s": _DEG * 1e-3, "deg/h": _DEG / _H,
        "deg/min": _DEG / 60, "rad/h": 1 / _H, "rad/min": 1 / 60, "arcsec/s": _DEG / _H, "arcsec/h": _DEG / _H**2, "rpm": math.pi / 30,
        "rev/s": 2 * math.pi,
    },
    "specific_force": {
        "m/s²": 1, "g": _G, "mg": _G * 1e-3, "µg": _G * 1e-6, "m/s/h": 1 / _H, "cm/s²": 1e-2,
        "mGal": 1e-5, "µGal": 1e-8, "mm/s²": 1e-3, "ft/s²": 0.3048,
    },
    # N: a white-noise density. rad/s/√Hz and rad/√s are equal.
    "angular_rate_density": {
        "rad/s/√Hz": 1, "rad/√s": 1, "deg/s/√Hz": _DEG, "deg/√s": _DEG, "mdeg/s/√Hz": _DEG * 1e-3,
        "deg/√h": _DEG / _ROOT_H, "deg/h/√Hz": _DEG / _H,
    },
    "specific_force_density": {
        "m/s²/√Hz": 1, "m/s/√s": 1, "m/s/√h": 1 / _ROOT_H, "g/√Hz": _G, "mg/√Hz": _G * 1e-3,
        "µg/√Hz": _G * 1e-6,
    },
    # K: a rate random walk. 1/h^1.5 = 1/(3600·60) of 1/s^1.5.
    "angular_rate_walk": {
        "rad/s/√s": 1, "rad/s²/√Hz": 1, "deg/s/√s": _DEG, "deg/h/√h": _DEG / (_H * _ROOT_H),
        "deg/h^1.5": _DEG / (_H * _ROOT_H),
    },
    "specific_force_walk": {
        "m/s²/√s": 1, "m/s³/√Hz": 1, "m/s/h^1.5": 1 / (_H * _ROOT_H), "mg/√s": _G * 1e-3,
    },
    # R: a rate ramp.
    "angular_acceleration": {"rad/s²": 1, "deg/s²": _DEG, "deg/h²": _DEG / _H**2},
    "jerk": {"m/s³": 1, "m/s/h²": 1 / _H**2},
    "dimensionless": {"1": 1, "%": 1e-2, "ppm": 1e-6},
}  # fmt: skip

UNITS: dict[str, Unit] = {
    name: Unit(name, dimension, float(factor)) for dimension, row in _TABLE.items() for name, factor in row.items()
} | {
    "°C": Unit("°C", "temperature", 1.0),
    "K": Unit("K", "temperature", 1.0, -273.15),
    "cdegC": Unit("cdegC", "temperature", 1e-2),
    "°F": Unit("°F", "temperature", 5 / 9, -160 / 9),
}

#: Other spelling -> name in the table; ``_canonical`` comes first.
_ALIASES = {
    "counts": COUNT, "dps": "deg/s", "deg/sec": "deg/s", "degps": "deg/s", "°/s": "deg/s", "rad/sec": "rad/s",
    "rads": "rad/s", "°/h": "deg/h", "deg/hr": "deg/h", "mps2": "m/s²", "ms2": "m/s²", "m/s/s": "m/s²",
    "m/s2": "m/s²", "ms-2": "m/s²", "m/ss": "m/s²", "m/sec²": "m/s²", "gee": "g", "mgee": "mg", "ug": "µg",
    "μg": "µg", "ug/√hz": "µg/√Hz", "μg/√hz": "µg/√Hz", "sec": "s", "seconds": "s", "msec": "ms",
    "usec": "us", "µs": "us", "μs": "us", "nsec": "ns", "degc": "°C", "c": "°C", "celsius": "°C",
    "degf": "°F", "f": "°F", "fahrenheit": "°F",
    "degree": "deg", "degrees": "deg", "°": "deg", "mps": "m/s", "kmh": "km/h", "kph": "km/h",
    "dph": "deg/h", "degph": "deg/h", "°/min": "deg/min", "rad/hr": "rad/h", '"/s': "arcsec/s", "''/s": "arcsec/s", "arcsec/hr": "arcsec/h",
    "rps": "rev/s", "rev/min": "rpm", "r/min": "rpm", "gn": "g", "g0": "g", "n/kg": "m/s²", "microg": "µg", "millig": "mg", "milli-g": "mg",
    "micro-g": "µg", "g*s": "g·s", "g-s": "g·s", "gsec": "g·s", "mg*s": "mg·s", "ug*s": "µg·s",
    "radpersec": "rad/s", "degpersec": "deg/s", "mdps": "mdeg/s", "ugal": "µGal", "gal": "cm/s²", "m/^s": "m/s²",
    "as/s": "arcsec/s", "arcseconds": "arcsec", "knots": "knot", "kts": "knot", "kt": "knot", "kn": "knot", "kmph": "km/h",
    "1e-7deg": "degE7", "deg*1e-7": "degE7", "degx1e-7": "degE7", "deg*10^-7": "degE7", "10^-7deg": "degE7", "urad/s": "µrad/s",
    "deg/√hr": "deg/√h", "°/√h": "deg/√h", "m/s/√hr": "m/s/√h", "degs": "deg/s", "": "1",
}  # fmt: skip
_FOLDED = {name.lower(): name for name in UNITS}  # only "K" would differ by case alone


def _canonical(text: str) -> str:
    text = text.strip().replace(" ", "").replace("**", "^")
    text = re.sub(r"sqrt\(?([A-Za-z]+)\)?", r"√\1", text)
    text = re.sub(r"(?<=/)rt\(?(Hz|hr?)\)?$", r"√\1", text)
    text = re.sub(r"^(m?)dps(?=/√)", r"\1deg/s", text)
    return text.replace("^2", "²").replace("^3", "³").replace("^(3/2)", "^1.5").replace("·", "")


#: word of a spelled unit -> its sign
_WORDS = {
    "radian": "rad", "degree": "deg", "second": "s", "sec": "s", "hour": "h", "hr": "h", "minute": "min", "revolution": "rev", "turn": "rev",
    "meter": "m", "metre": "m", "per": "/", "millisecond": "ms", "microsecond": "us", "nanosecond": "ns", "arcsecond": "arcsec", "squared": "²", "°": "deg", "dgr": "deg",
}  # fmt: skip
_EXPONENT = re.compile(r"[.*⋅]?(s|h)\^?[-−⁻]([12¹²])$")


def _spelled(name: str) -> str | None:
    """Return a unit that is written with words or negative exponents: ``rad s^-1``, ``m.s-2``, ``degrees per second``."""
    text = re.sub(
        r"[a-z°]+", lambda word: _WORDS.get(word[0]) or _WORDS.get(word[0].removesuffix("s"), word[0]), name.lower()
    )
    text = _canonical(text)
    text = _EXPONENT.sub(lambda found: f"/{found[1]}" + ("²" if found[2] in "2²" else ""), text)
    text = re.sub(r"(?<=/)\(s²?\)$|(?<=/s)2$", lambda found: found[0].strip("()").replace("2", "²"), text)
    return text if text in UNITS else _FOLDED.get(text) or _ALIASES.get(text)


_NUMBER = r"\d+(?:\.\d*)?(?:e[+-]?\d+)?"
_OFFSET = rf"(?:\s*(?P<sign>[+-])\s*(?P<offset>{_NUMBER}))?"
_LSB = r"(?:LSBs?|counts?|digits?)"
#: forms of a scale: counts in a unit, or a unit's part that is one count; an offset is in the unit
_SCALES = tuple(
    re.compile(pattern + _OFFSET, re.IGNORECASE)
    for pattern in (
        rf"(?P<counts>{_NUMBER})\s*{_LSB}\s*/\s*(?:\((?P<inner>[^()]+)\)|(?P<unit>[^()+]+?))",
        rf"(?P<size>{_NUMBER})\s*(?P<unit>[^()+\d][^()+]*?)\s*/\s*{_LSB}",
        rf"(?P<size>{_NUMBER})\s*/\s*(?P<counts>{_NUMBER})\s*(?P<unit>[^()+\d][^()+]*?)",
    )
)


def _scale(name: str) -> Unit | None:
    """Return the unit of counts: ``131LSB/(deg/s)``, ``0.061 mg/LSB``, ``1/16384 g``, ``340LSB/°C+36.53``; None for another text."""
    match = next((found for scale in _SCALES if (found := scale.fullmatch(name.strip()))), None)
    if match is None:
        return None
    parts = match.groupdict()
    measure = unit(parts.get("inner") or parts["unit"])
    counts, size = float(parts.get("counts") or 1), float(parts.get("size") or 1)
    if not counts or not size:
        raise UsageError(f"the scale {name!r} is 0 or infinite; write it as in 131LSB/(deg/s)")
    offset = float(parts["offset"] or 0) * (-1 if parts["sign"] == "-" else 1)
    return Unit(
        re.sub(r"\s+", " ", name.strip()), measure.dimension, measure.factor * size / counts, measure.to_si(offset)
    )


def unit(name: str) -> Unit:
    """Return the unit of that name, in any common spelling, or the scale of counts, such as ``131LSB/(deg/s)``.

    Raises:
        UsageError: there is no such unit; the message lists all units.
    """
    name = str(name)  # a number is no unit either
    text = _canonical(name)
    folded = text.lower()
    stated = name.strip()
    known = (
        stated
        if stated in UNITS
        else text
        if text in UNITS
        else _FOLDED.get(folded) or _ALIASES.get(folded) or _spelled(name)
    )
    if known is None:
        scale = _scale(name)
        if scale is not None:
            return scale
        raise UsageError(
            f"unknown unit {name!r}; write one of: {', '.join(UNITS)}, or the scale of counts, such as 131LSB/(deg/s)"
        )
    return UNITS[known]


def quantity(stated: object, si: Unit, where: str, example: str = "") -> float:
    """Return a value above 0 that is stated as a number and its unit, such as ``"0.3 deg/√h"``, in SI.

    Args:
        stated: what a document states.
        si: SI unit of the quantity.
        where: the place in the document, for messages.
        example: a unit that the message names; the SI unit by default.

    Raises:
        UsageError: no number, no unit, one of another quantity, or a value that is not above 0.
    """
    number, _, name = (stated if isinstance(stated, str) else "").strip().partition(" ")
    example = example or si.name
    try:
        given = unit(name)
        value = given.to_si(float(number))
    except (ValueError, UsageError) as error:
        raise UsageError(
            f'{where} = {stated!r:.80}; it must be a number and its unit, such as "0.3 {example}"'
        ) from error
    if not name or given.dimension != si.dimension or not 0 < value < math.inf:
        raise UsageError(f"{where} = {stated!r:.80}; it must be positive, with a unit such as {example}")
    return value


def unix_nanoseconds(when: datetime) -> int:
    """Return an instant as ns since 1970 UTC, exact to the microsecond; a date without a time zone is UTC."""
    since = (when if when.tzinfo else when.replace(tzinfo=UTC)) - UNIX_EPOCH
    return (since.days * 86_400 + since.seconds) * SECOND + since.microseconds * 1000


def units_of(dimension: str) -> tuple[str, ...]:
    """Return the units of a dimension, the SI unit first."""
    return tuple(name for name, own in UNITS.items() if own.dimension == dimension)


def si_unit(dimension: str) -> str:
    """Return the SI unit of a dimension; °C for temperature."""
    return "°C" if dimension == "temperature" else next(iter(_TABLE[dimension]))


#: (sensor, coefficient) -> (SI unit, unit of data sheets and papers)
_COEFFICIENT_UNITS: dict[tuple[str, str], tuple[str, str]] = {
    ("gyro", "Q"): ("rad", "arcsec"),
    ("gyro", "N"): ("rad/s/√Hz", "deg/√h"),
    ("gyro", "B"): ("rad/s", "deg/h"),
    ("gyro", "K"): ("rad/s/√s", "deg/h^1.5"),
    ("gyro", "R"): ("rad/s²", "deg/h²"),
    ("gyro", "rate"): ("rad/s", "deg/s"),
    ("accel", "Q"): ("m/s", "mm/s"),
    ("accel", "N"): ("m/s²/√Hz", "m/s/√h"),
    ("accel", "B"): ("m/s²", "µg"),
    ("accel", "K"): ("m/s²/√s", "m/s/h^1.5"),
    ("accel", "R"): ("m/s³", "m/s/h²"),
    ("accel", "rate"): ("m/s²", "mg"),
}


def coefficient_units(axis: str, coefficient: str) -> tuple[Unit, Unit]:
    """Return SI unit and display unit of a coefficient (Q, N, B, K, R or ``rate``) of an axis such as ``gyro_x``."""
    si, display = _COEFFICIENT_UNITS[axis.split("_", maxsplit=1)[0], coefficient]
    return UNITS[si], UNITS[display]

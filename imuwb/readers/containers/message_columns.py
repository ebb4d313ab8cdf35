"""How the fields of a message become the columns of a stream: SI units, FRD body axes, north-east-down.

A field is named by its path in the message: ``twist.linear.x`` is a number, ``gyro_rad[3]`` an array of three numbers, and
``covariance[0]`` the first number of an array of any length. A minus sign before a name turns the number's sign.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats
from imuwb.geodesy import swapped_axes
from imuwb.ros import ABSENT, UNKNOWN

#: {path: (n,) or (n, k)}; the paths have no length of an array, except ``[0]``
Values = Mapping[str, Floats]
Convert = Callable[[Values, str], Floats | None]

DEGREES = np.pi / 180
NONE = -np.inf  #: of a body vector that a message lacks
NEAR_ONE = 0.05  #: a quaternion whose length differs from one by more is no attitude
FASTEST = 1e9  #: a larger number is a mark that there is none; receivers of Septentrio send -2e10
RADIAL_95, LINEAR_95 = 2.4477, 1.96  #: 95 % bounds of an error in the plane and along a line, in sigmas of an axis


@dataclass(frozen=True, slots=True)
class Quantity:
    """One column of a stream."""

    column: str
    fields: tuple[str, ...]  #: that it needs
    convert: (
        Convert  #: (values, body frame of the message) -> (n,) or (n, k); None where the messages lack the quantity
    )
    optional: tuple[str, ...] = ()  #: fields that it uses if the message has them
    needed: bool = True  #: whether a message without these fields is no message of this shape


def path_of(field: str) -> str:
    """Return the path of a field: without its sign, and without the length of an array."""
    bare = field.removeprefix("-")
    return bare if bare.endswith("[0]") else bare.partition("[")[0]


def xyz(name: str) -> tuple[str, str, str]:
    """Return the fields of a vector."""
    return f"{name}.x", f"{name}.y", f"{name}.z"


def triad(column: str, *names: str, scale: float = 1.0, absent: str = "", needed: bool = True) -> Quantity:
    """Return a body vector; its first axis points forward.

    Args:
        column: ``angular_rate`` or ``specific_force``.
        names: three numbers, or an array of three.
        scale: of one of the numbers, in SI units.
        absent: first number of its covariance; -1 marks a message without this vector.
        needed: as in ``Quantity``.
    """

    def convert(values: Values, frame: str) -> Floats | None:
        missing = values[absent] == ABSENT if absent in values else None
        if missing is not None and not missing.any():
            missing = None  # nearly all messages
        if missing is not None and missing.all():
            return None
        vector = np.empty((values[path_of(names[0])].shape[0], 3))
        for axis, part in enumerate(_parts(values, names)):  # by columns, ten times faster than by rows
            if axis and frame == "FLU":
                np.negative(part, out=vector[:, axis])
            else:
                vector[:, axis] = part
        if scale != 1.0:
            vector *= scale
        if missing is not None:
            vector[missing] = NONE
        return vector

    return Quantity(column, names, convert, (absent,) if absent else (), needed)


def vector(column: str, *names: str, scale: float = 1.0, needed: bool = False, or_none: bool = False) -> Quantity:
    """Return numbers side by side; a mark that there is none is nan; with ``or_none``, None if all are such marks."""

    def convert(values: Values, frame: str) -> Floats | None:
        rows = np.stack([*_parts(values, names)], axis=1) * scale
        known = np.where(np.abs(rows) < FASTEST, rows, np.nan)
        return None if or_none and np.isnan(known).all() else known

    return Quantity(column, names, convert, needed=needed)


def sigmas(
    column: str,
    *names: str,
    scale: float | tuple[float, float, float] = 1.0,
    variances: bool = False,
    none: float = 0.0,
) -> Quantity:
    """Return sigmas, north, east and down, of numbers that are sigmas or variances; if not positive, or ``none``, they are not known."""

    def convert(values: Values, frame: str) -> Floats | None:
        rows = np.stack([*_parts(values, names)], axis=1)
        known = np.where((rows > 0) & (rows < FASTEST) & (rows != none), rows, np.nan) * np.array(scale)
        return np.sqrt(known) if variances else known

    return Quantity(column, names, convert, needed=False)


def covariance(column: str, name: str, size: int, kind: str = "") -> Quantity:
    """Return sigmas, north, east and down, of an east-north-up covariance, (size, size); ``kind`` 0 states that it is not known."""

    def convert(values: Values, frame: str) -> Floats | None:
        square = values[name][:, np.array([1, 0, 2]) * (size + 1)]  # of north, east and down
        known = square > 0  # unknown (0) or absent (-1) variances are not positive
        if kind in values:
            known &= values[kind][:, None] > 0
        return np.sqrt(np.where(known, square, np.nan))

    return Quantity(column, (f"{name}[{size * size}]",), convert, (kind,) if kind else (), needed=False)


def diagonal(column: str, name: str, size: int) -> Quantity:
    """Return sigmas along the axes of a frame of its own, of a covariance, (size, size)."""

    def convert(values: Values, frame: str) -> Floats | None:
        square = values[name][:, np.arange(3) * (size + 1)]
        return np.sqrt(np.where(square > 0, square, np.nan))

    return Quantity(column, (f"{name}[{size * size}]",), convert, needed=False)


def fix_sigmas(covariance_name: str, kind: str, horizontal: str, vertical: str) -> Quantity:
    """Return sigmas of a ``gps_common/GPSFix``: of its covariance, or else of its bounds, which hold with 95 %."""
    known = covariance("position_sigma", covariance_name, 3, kind)

    def convert(values: Values, frame: str) -> Floats | None:
        rows = known.convert(values, frame)
        bounds = values[horizontal] / RADIAL_95, values[horizontal] / RADIAL_95, values[vertical] / LINEAR_95
        stated = np.stack([np.where(bound > 0, bound, np.nan) for bound in bounds], axis=1)
        return stated if rows is None else np.where(np.isfinite(rows), rows, stated)

    return Quantity("position_sigma", (*known.fields, horizontal, vertical), convert, known.optional, needed=False)


def position(
    latitude: str, longitude: str, *heights: str, angle: float = DEGREES, scale: float = 1.0, above: str = ""
) -> Quantity:
    """Return latitude, longitude and height.

    Args:
        latitude: field.
        longitude: field.
        heights: fields, of which the first that a message has is used; 0 without any.
        angle: unit of the angles, rad.
        scale: unit of the height, m.
        above: field of the geoid's height (m), if the height is above it; the sum is used.
    """

    def convert(values: Values, frame: str) -> Floats | None:
        north = values[latitude]
        height = next((values[name] for name in heights if name in values), np.zeros_like(north)) * scale
        if above in values:
            height = height + values[above]
        rows = np.stack([north * angle, values[longitude] * angle, height], axis=1)
        return np.where(np.abs(rows) < FASTEST, rows, np.nan)

    return Quantity("position", (latitude, longitude), convert, (*heights, *((above,) if above else ())))


def course(track: str, speed: str, climb: str, sigma: str = "", climb_sigma: str = "") -> tuple[Quantity, ...]:
    """Return the velocity of a track (deg from north), a speed over ground and a speed upwards, with its sigmas if it states them."""

    def convert(values: Values, frame: str) -> Floats | None:
        angle, over = np.radians(values[track]), values[speed]
        down = -values[climb] if climb in values else np.full_like(over, np.nan)
        return np.stack([over * np.cos(angle), over * np.sin(angle), down], axis=1)

    def bound(values: Values, frame: str) -> Floats | None:
        over, up = (np.where(values[name] > 0, values[name], np.nan) / LINEAR_95 for name in (sigma, climb_sigma))
        return np.stack([over, over, up], axis=1)

    velocity = Quantity("velocity", (track, speed), convert, (climb,), needed=False)
    return (velocity, Quantity("velocity_sigma", (sigma, climb_sigma), bound, needed=False)) if sigma else (velocity,)


def fix_type(field: str, types: Mapping[int, int], other: int = 3, sound: str = "") -> Quantity:
    """Return fix types, numbered as in ``GnssStream``, of a message's own numbers; a ``sound`` other than 0 is no fix."""
    keys, kinds = np.array(list(types), float), np.array(list(types.values()), float)

    def convert(values: Values, frame: str) -> Floats | None:
        own = values[field]
        if (own == UNKNOWN).all():
            return None
        found = own[:, None] == keys
        rows = np.where(found.any(axis=1), kinds[found.argmax(axis=1)], float(other))
        return np.where(values[sound] != 0, 1.0, rows) if sound in values else rows

    return Quantity("fix_type", (field,), convert, (sound,) if sound else (), needed=False)


def ublox_fix(fix: str, flags: str) -> Quantity:
    """Return fix types of UBX-NAV-PVT; bits 6 and 7 of the flags are the carrier solution."""

    def convert(values: Values, frame: str) -> Floats | None:
        from imuwb.readers.receivers.ubx_streams import fix_types  # noqa: PLC0415 - few recordings have these messages

        bits = values[flags].astype(np.int64)
        return fix_types(values[fix].astype(np.int64), bits, bits >> 6)

    return Quantity("fix_type", (fix, flags), convert, needed=False)


def single(column: str, field: str, scale: float = 1.0, *, needed: bool = True) -> Quantity:
    """Return one number that is the same in all frames."""
    return Quantity(column, (field,), lambda values, _: values[field] * scale, needed=needed)


def rotation(w: str, x: str, y: str, z: str, *, whole: bool = False) -> Quantity:
    """Return the quaternions of a pose in a frame of its own; with ``whole``, of an array w, x, y, z in FRD axes."""
    names = (w,) if whole else (w, x, y, z)

    def convert(values: Values, frame: str) -> Floats | None:
        rows = np.stack([*_parts(values, names, 4)], axis=1)
        length = np.linalg.norm(rows, axis=1, keepdims=True)
        rows = rows / np.where(length > 0, length, np.nan)
        # A turn by half a circle about the forward axis makes forward-left-up of forward-right-down.
        return np.stack([-rows[:, 1], rows[:, 0], rows[:, 3], -rows[:, 2]], axis=1) if whole else rows

    return Quantity("quaternion", names, convert)


def orientation() -> tuple[Quantity, ...]:
    """Return the orientation of ``sensor_msgs/Imu``, nan where a message states none, and its sigmas."""
    names, stated_by = tuple(f"orientation.{part}" for part in "wxyz"), "orientation_covariance"

    def convert(values: Values, frame: str) -> Floats | None:
        quaternion = np.stack([values[name] for name in names], axis=1)
        # Damaged numbers may be too large to be squared.
        quaternion[(~(np.abs(quaternion) < 1 + NEAR_ONE)).any(axis=1)] = np.nan
        length = np.linalg.norm(quaternion, axis=1, keepdims=True)
        stated = np.abs(length - 1) < NEAR_ONE
        if stated_by in values:
            stated &= values[stated_by][:, :1] != ABSENT
        quaternion /= np.where(stated, length, np.nan)
        # An IMU whose axes are stated as FRD is taken to state its attitude relative to NED as well.
        return swapped_axes(quaternion) if frame == "FLU" else quaternion

    turn = Quantity("quaternion", names, convert, (f"{stated_by}[9]",))
    return turn, covariance("sigma", stated_by, 3)


def whole(column: str, name: str, *, needed: bool = True) -> Quantity:
    """Return an array of three numbers of imuwb's own message; None unless all are finite, of sigmas unless some are."""

    def convert(values: Values, frame: str) -> Floats | None:
        known = np.isfinite(values[name])
        return values[name] if (known.all() if needed else known.any()) else None

    return Quantity(column, (f"{name}[3]",), convert, needed=needed)


def _parts(values: Values, names: tuple[str, ...], count: int = 3) -> list[Floats]:
    """Return numbers, or the numbers of one array, with their signs."""
    if len(names) == 1:
        rows = values[path_of(names[0])]
        return [rows[:, axis] for axis in range(count)]
    return [-values[name[1:]] if name.startswith("-") else values[name] for name in names]

"""What the numbers of an IMU say of their unit: an accelerometer at rest measures one gravity."""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from imuwb.arrays import Floats
from imuwb.errors import UnreadableLogError
from imuwb.readers.text.column_names import Column
from imuwb.readers.text.trust import is_number
from imuwb.units import COUNT, STANDARD_GRAVITY, UNITS, Unit

STILL = 0.1  #: largest relative difference between the specific force at rest and standard gravity
WRONG = 2.0  #: factor between the specific force and one gravity, beyond which the stated unit is doubtful
NO_FORCE = 2.0  #: m/s²; a median |f| below is no specific force of anything that rests or drives on Earth
DAMAGED = 1e9  #: a larger number is damage, whatever its unit
COUNTS = (16384, 8192, 4096, 2048, 1024, 256)  #: LSB/g of common accelerometers
COUNTED = 0.05  #: largest relative difference between the specific force at rest in counts and one gravity
NO_GRAVITY = (
    "an accelerometer at rest measures one gravity, so this is an acceleration without gravity, or increments: it is no specific "
    "force, and in no unit one"
)


def quartiles(values: Floats) -> tuple[float, float, float]:
    """Return the values that a quarter, half, and three quarters of all values do not exceed.

    numpy's own functions import its masked arrays, which take longer than a small log.
    """
    ordered = np.sort(values)
    first, middle, third = (float(ordered[(values.size - 1) * quarter // 4]) for quarter in (1, 2, 3))
    return first, middle, third


def hint(quantity: str, rows: Sequence[Sequence[str]]) -> str:
    """Return what the first rows of a gyro or an accelerometer show of its unit.

    Args:
        quantity: ``gyro`` or ``accel``.
        rows: the cells of its axes.
    """
    known = np.array([[float(x) for x in row] for row in rows if all(map(is_number, row))]).reshape(-1, len(rows[0]))
    sound = known[(np.abs(known) < DAMAGED).all(axis=1)]
    whole = sound.size > 0 and bool((sound == np.rint(sound)).all())
    if quantity == "gyro":
        counts = "whole numbers, so likely counts, such as 131LSB/(deg/s) of a data sheet"
        return counts if whole and np.abs(sound).max() > 1 else "deg/s or rad/s"
    if not sound.size:
        return "g or m/s²"
    norms = np.linalg.norm(sound, axis=1)
    _, norm, _ = quartiles(norms)
    scale = next((lsb for lsb in COUNTS if abs(norm / lsb - 1) < COUNTED), None)
    if whole and scale is not None:
        return f"whole numbers with |f| = {norm:.4g}, so likely counts: {scale}LSB/g"
    likely = _likely(norms)
    if likely is None and norm < NO_FORCE and sound.shape[1] == 3 and len(sound) > 1:  # noqa: PLR2004 - three axes
        return f"|f| is {norm:.4g}; {NO_GRAVITY}"
    return f"|f| is {norm:.4g}, so likely {likely or 'g or m/s²'}"


def check_gravity(path: Path, force: Floats, used: Sequence[Column]) -> bool:
    """Return whether there are samples to check.

    Raises:
        UnreadableLogError: the samples are one gravity in another unit than the stated one, or no specific force.
    """
    stated = next(column.unit for column in used if column.quantity == "accel")
    if stated is not None and stated.name == COUNT:
        return True
    sound = force[np.isfinite(force).all(axis=1) & (np.abs(force) < DAMAGED).all(axis=1)]
    if not sound.size:
        return False
    norms = np.linalg.norm(sound, axis=1)
    _, norm, _ = quartiles(norms)
    if stated is not None and "lsb" in stated.name.lower():
        _check_range(path, norms, stated)
    if stated is None or STANDARD_GRAVITY / WRONG < norm < WRONG * STANDARD_GRAVITY:
        return True
    likely = _likely(norms / stated.factor)
    if likely is not None:
        raise UnreadableLogError(
            f"{path}: accel is stated in {stated.name}, but |f| is {norm / stated.factor:.4g}; an accelerometer at rest "
            f"measures one gravity, so the unit is likely {likely}: --units accel={likely}"
        )
    if norm < NO_FORCE:
        raise UnreadableLogError(
            f"{path}: accel is stated in {stated.name}, and |f| is {norm:.4g} m/s² in the median; {NO_GRAVITY}; leave its columns out with "
            "--columns"
        )
    return True


def _check_range(path: Path, norms: Floats, stated: Unit) -> None:
    """Refuse a scale of counts that is wrong by a power of two, as that of another measuring range is.

    Raises:
        UnreadableLogError: half of all samples are twice, four times, half ... one gravity.
    """
    low, _, high = (norm / STANDARD_GRAVITY for norm in quartiles(norms))
    power = round(math.log2(max(low, 1e-9)))
    if power and abs(low / 2**power - 1) < STILL and abs(high / 2**power - 1) < STILL:
        lsb = 1 / stated.factor * STANDARD_GRAVITY * 2.0**power
        raise UnreadableLogError(
            f"{path}: with accel={stated.name}, |f| is {low:.4g} times gravity in the median; the sensor has likely another measuring range: "
            f"--units accel={lsb:.0f}LSB/g"
        )


def _likely(norms: Floats) -> str | None:
    """Return the unit in which at least half of the specific forces are about one gravity; None if there is none."""
    low, _, high = quartiles(norms)
    for name in ("m/s²", "g", "mg"):
        ratio = UNITS[name].factor / STANDARD_GRAVITY
        if abs(low * ratio - 1) < STILL and abs(high * ratio - 1) < STILL:
            return name
    return None

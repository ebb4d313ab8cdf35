"""What the numbers of a receiver say of their unit: no latitude is beyond 90 degrees, and nothing that drives or flies is in space."""

from collections.abc import Collection, Sequence
from pathlib import Path

import numpy as np

from imuwb.arrays import Floats
from imuwb.errors import UnreadableLogError
from imuwb.readers.text.column_names import Column, columns
from imuwb.units import unit

POLE, ROUND = (
    np.pi / 2 + 1e-9,
    2 * np.pi + 1e-9,
)  #: rad; the largest latitude, and the largest longitude, of 0 to 360 degrees
HIGHEST = 1e5  #: m; a larger height is likely in another unit
#: numbers up to these may be rad; in degrees, such places are all in the Gulf of Guinea
RADIANS = (1.5708, 3.1416)
MINUTES = (9_000, 18_000)  #: largest numbers of degrees and minutes in one (ddmm.mmmm)


def check_position(path: Path, position: Floats, used: Sequence[Column], stated: Collection[str]) -> bool:
    """Return whether there are fixes to check.

    Args:
        path: the log.
        position: (n, 3) latitude and longitude rad, height m.
        used: the columns of the log.
        stated: the quantities whose units the user or the log's known shape states.

    Raises:
        UnreadableLogError: the numbers are no latitudes, longitudes or heights in their unit, or their unit is unknown.
    """
    sound = position[np.isfinite(position).all(axis=1)]
    sound = sound[(sound[:, :2] != 0).any(axis=1)]  # 0, 0 stands for no fix
    if not len(sound):
        return False
    latitude, longitude, height = (float(x) for x in np.sort(np.abs(sound), axis=0)[len(sound) // 2])
    column = next(column for column in used if column.quantity == "latitude")
    measure = column.unit or unit("deg")
    numbers = latitude / measure.factor, longitude / measure.factor
    they_are = f"they are {numbers[0]:.6g} and {numbers[1]:.6g} in the median"
    if latitude > POLE or longitude > ROUND:
        raise UnreadableLogError(
            f"{path}: latitude and longitude are taken in {measure.name}, but {they_are}; {_likely(*numbers)}"
        )
    unnamed = "latitude" not in stated and all(other.unit is None for other in columns((column.name,), {}))
    if unnamed and numbers[0] <= RADIANS[0] and numbers[1] <= RADIANS[1]:
        raise UnreadableLogError(
            f"{path}: the unit of latitude and longitude is unknown, and {they_are}, so likely rad: --units position=rad, or position=deg"
        )
    if height > HIGHEST and "height" not in stated:
        raise UnreadableLogError(
            f"{path}: the height is {height:.6g} m in the median, so its unit is likely another: --units height=mm, or height=m"
        )
    return True


def _likely(latitude: float, longitude: float) -> str:
    """Return what the numbers show: a unit, or degrees and minutes in one number."""
    if latitude <= MINUTES[0] and longitude <= MINUTES[1]:
        return "likely degrees and minutes (ddmm.mmmm): write them as degrees"
    factor = unit("degE7").factor
    if latitude * factor <= POLE and longitude * factor <= ROUND:
        return "the unit is likely degE7: --units position=degE7"
    return "state the unit: --units position=UNIT"

"""Velocities that contradict their own positions, found for each kind of fix and left out.

A receiver may report velocities of another solution than its positions, or with the wrong sign or unit, and still claim a small
sigma. Over pairs of fixes in motion, the displacement over the time between them must be the mean of both velocities.
"""

from dataclasses import replace

import numpy as np

from imuwb.arrays import Booleans, Floats
from imuwb.geodesy.earth import ned_scale
from imuwb.log import SECOND, GnssStream
from imuwb.notes import Note

BASELINE = (0.95, 2.6)  #: s between the two fixes of a pair
MOVING = 3.0  #: m/s
FEW = 10  #: pairs; a kind with fewer pairs cannot be judged
WORST, SHARE = 1.0, 0.2  #: m/s, and of the median speed: a larger median contradiction is an error of the kind
USUAL = 2.5  #: m, sigma of a position without a sigma
RAYLEIGH = 1.18  #: median of the length of a vector over the sigma of its two components
NAMES = {3: "3D", 4: "DGPS", 5: "RTK float", 6: "RTK fixed"}  #: fix type -> its name


def consistent(gnss: GnssStream) -> tuple[GnssStream, tuple[Note, ...]]:
    """Return a receiver without the velocities of the kinds of fix whose velocities contradict their positions.

    Args:
        gnss: positions, velocities and, where it has them, fix types.
    """
    if gnss.velocity is None or len(gnss) < FEW:
        return gnss, ()
    kind = np.zeros(len(gnss), np.int64) if gnss.fix_type is None else gnss.fix_type
    bad = np.zeros(len(gnss), dtype=bool)
    notes: list[Note] = []
    for value in np.unique(kind):
        rows = np.flatnonzero(kind == value)
        contradiction, speed, explained = _contradictions(gnss, rows)
        if contradiction.size < FEW:
            continue
        median, usual = float(np.median(contradiction)), float(np.median(speed))
        if median > max(WORST, SHARE * usual) + RAYLEIGH * float(np.median(explained)):
            bad[rows] = True
            text = (
                f"{gnss.name}: the velocities of {rows.size} {_name(gnss, int(value))} differ from the displacement of their own "
                f"positions by {median:.1f} m/s in the median, at {usual:.1f} m/s; these velocities are not used"
            )
            notes.append(Note("contradicting-velocities", text))
    return (replace(gnss, velocity=_without(gnss.velocity, bad)), tuple(notes)) if notes else (gnss, ())


def _name(gnss: GnssStream, kind: int) -> str:
    return "fixes" if gnss.fix_type is None else f"{NAMES.get(kind, f'type {kind}')} fixes"


def _without(velocity: Floats, bad: Booleans) -> Floats | None:
    return None if bad.all() else np.where(bad[:, None], np.nan, velocity)


def _contradictions(
    gnss: GnssStream, rows: np.ndarray[tuple[int], np.dtype[np.int64]]
) -> tuple[Floats, Floats, Floats]:
    """Return, for pairs of fixes of one kind in motion, the horizontal contradiction, the speed, and the displacement's sigma, m/s."""
    time, position = gnss.time[rows] / SECOND, gnss.position[rows]
    velocity = gnss.velocity[rows, :2] if gnss.velocity is not None else np.full((rows.size, 2), np.nan)
    later = np.searchsorted(time, time + BASELINE[0])
    first = np.flatnonzero(later < rows.size)
    second = later[first]
    span = time[second] - time[first]
    moved = (position[second] - position[first]) * ned_scale(position[first, 0], position[first, 2])
    mean = (velocity[first] + velocity[second]) / 2
    speed = np.hypot(mean[:, 0], mean[:, 1])
    displacement = moved[:, :2] / span[:, None]
    # What moves by one of the two accounts counts: velocities of zero may be the error.
    moving = np.maximum(speed, np.hypot(displacement[:, 0], displacement[:, 1])) > MOVING
    kept = moving & (span <= BASELINE[1]) & np.isfinite(mean).all(axis=1) & np.isfinite(displacement).all(axis=1)
    off = displacement[kept] - mean[kept]
    sigma = np.full(rows.size, USUAL)
    if gnss.position_sigma is not None:
        sigma = np.nan_to_num(gnss.position_sigma[rows, :2].max(axis=1), nan=USUAL)
    explained = np.hypot(sigma[first], sigma[second]) / span
    fastest = np.maximum(speed, np.hypot(displacement[:, 0], displacement[:, 1]))
    return np.hypot(off[:, 0], off[:, 1]), fastest[kept], explained[kept]

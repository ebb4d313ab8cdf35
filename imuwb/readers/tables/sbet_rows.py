"""The rows of an SBET file: time of week, position, velocity, attitude; the velocity's axes are found by the positions.

A row is time (s of the week, or of the day), latitude, longitude (rad), height (m, ellipsoid), velocity x, y, z (m/s), roll, pitch,
platform heading, wander angle (rad), body acceleration (m/s²), body rate (rad/s). The true heading is the platform heading minus the
wander angle; source: the Area Based Editor of NAVOCEANO, FilePOSOutput.h. No document at hand states the axes of the velocity, and
programs differ (Delph INS writes those of the vehicle), so the positions decide; without motion there is no velocity.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from imuwb.arrays import Floats
from imuwb.geodesy import ned_scale
from imuwb.log import Origin
from imuwb.notes import Note
from imuwb.readers.batch import Batch, Remark, unused
from imuwb.readers.bytes import source
from imuwb.readers.tables.array_tables import doubles
from imuwb.units import SECOND

WIDTH, ROWS = 17, 20_000  #: numbers in a row; rows in a batch
LEAST_SPEED = 1.0  #: m/s; slower rows do not show the axes of the velocity
FITS = 0.1, 0.2  #: m/s, and share of the speed: largest median difference of a velocity from that of the positions
#: axes of the velocity -> its part down as a multiple of z
_DOWN = {"down": 1.0, "up": -1.0}
WAYS = ("wander-", "wander+", "vehicle-right", "vehicle-left")


def streamed(path: Path) -> Iterator[Batch | Remark]:
    """Yield the trajectory, some thousand rows at a time."""
    rows = doubles(path, WIDTH)
    way, down = _axes(rows)
    origin = Origin("rad, m, m/s", "NED", "log")
    for first in range(0, len(rows), ROWS):
        part = np.asarray(rows[first : first + ROWS], np.float64)
        sound = np.isfinite(part[:, :11]).all(axis=1) & (np.abs(part[:, 0]) < 2**31) & (np.abs(part[:, 1]) <= np.pi / 2)
        lost = int(np.count_nonzero(~sound))
        if lost:
            yield Remark(Note("not_finite", "rows with a value that is not a number left out"), "sbet", lost)
        part = part[sound]
        turn = -1.0 if way != "wander+" else 1.0
        columns = {
            "position": part[:, 1:4],
            "attitude": np.column_stack([part[:, 7:9], part[:, 9] + turn * part[:, 10]]),
        }
        if way is not None:
            columns["velocity"] = np.column_stack([*_horizontal(part, way).T, part[:, 6] * _DOWN[down]])
        time = np.rint(part[:, 0] * SECOND).astype(np.int64)
        yield Batch("sbet", "reference", time, columns, origin, 8 * WIDTH * (first + part.shape[0]))
    yield from map(Remark, _notes(path, way, down))
    yield unused(
        ["body accelerations", "body rates"],
        "the format does not state whether they contain gravity and the Earth's rate",
    )


def _notes(path: Path, way: str | None, down: str) -> Iterator[Note]:
    yield Note("week_unknown", "sbet: times of the GPS week, or of the day, without a date; they count from its start")
    if way is None:
        yield Note(
            "velocity_left_out", "sbet: the velocities are left out: the positions do not show which axes they have"
        )
    else:
        yield Note(
            "velocity_axes", f"sbet: by the positions, the velocities are along {way.rstrip('+-')} axes, z {down}"
        )
    rest = source.size(path) % (8 * WIDTH)
    with source.open_unpacked(path) as file:
        packed = source.is_packed(file)
    if rest and not packed:
        yield Note("row_cut", f"the last {rest} bytes are no whole row; the file is cut")


def _axes(rows: Floats) -> tuple[str | None, str]:
    """Return the axes of the horizontal velocity that fit the positions best, None if none fit, and the direction of z."""
    part = np.asarray(rows[: 10 * ROWS], np.float64)
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        step = np.diff(part[:, 0])[:, None]
        moved = np.diff(part[:, 1:4], axis=0) * ned_scale(part[1:, 1], part[1:, 3]) / step
        known = np.isfinite(moved).all(axis=1) & (step[:, 0] > 0) & (np.hypot(*moved[:, :2].T) > LEAST_SPEED)
        middle = (part[1:] + part[:-1])[known] / 2
    moved = moved[known]
    if not moved.size:
        return None, "down"
    off = {way: float(np.median(np.hypot(*(_horizontal(middle, way) - moved[:, :2]).T))) for way in WAYS}
    best = min(WAYS, key=lambda way: off[way])
    down = (
        "down"
        if np.median(np.abs(middle[:, 6] - moved[:, 2])) <= np.median(np.abs(middle[:, 6] + moved[:, 2]))
        else "up"
    )
    limit = FITS[0] + FITS[1] * float(np.median(np.hypot(*moved[:, :2].T)))
    return (best if off[best] < limit else None), down


def _horizontal(part: Floats, way: str) -> Floats:
    """Return velocities north and east, (n, 2), of rows whose velocity has certain axes."""
    heading, wander = part[:, 9], part[:, 10]
    angle = {"wander-": -wander, "wander+": wander}.get(way, heading - wander)  # azimuth of the axis x
    sideways = -part[:, 5] if way == "vehicle-left" else part[:, 5]
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.column_stack([part[:, 4] * cosine - sideways * sine, part[:, 4] * sine + sideways * cosine])

"""Tables of numbers without a header that hold a trajectory: TUM, poses of KITTI, and the navigation file of KF-GINS.

* TUM: ``time (s) x y z qx qy qz qw``, m; the quaternion's scalar is last.
* KITTI: the twelve numbers of a 3 x 4 pose, row by row, m; the times are in another file.
* KF-GINS: ``week, time of week (s), latitude, longitude (deg), height (m), velocity NED (m/s), roll, pitch, heading (deg)``. The
  standard deviations are in a file of their own, whose name has STD in place of Navresult.
"""

from datetime import timedelta
from pathlib import Path

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.errors import UnreadableLogError, UsageError
from imuwb.geodesy import rotation_of_quaternion
from imuwb.geodesy.local_track import LocalTrack
from imuwb.log import Origin, Reference
from imuwb.readers.gps_time import GPS_EPOCH, WEEK, ahead_of_utc
from imuwb.units import SECOND, UNIX_EPOCH

TUM, KITTI, KF_GINS = 8, 12, 11  #: numbers in a row
HEAD = 65_536  #: bytes in which the first row is looked for
UNIT = 0.01  #: largest difference of a quaternion's length, or of a rotation's product with its transpose, from one
LATEST = 9.2e9  #: s; later nanoseconds do not fit into int64
UNIX = 10**17  #: ns; a later time counts from 1970
TIMES = "times.txt"  #: name of the file beside KITTI's poses that has their times


def row_length(path: Path) -> int:
    """Return how many numbers the first row of a table without a header has; 0 for a file that is no such table."""
    with path.open("rb") as file:
        head = file.read(HEAD)
    if b"\0" in head:
        return 0
    lines = (line.split(b"#")[0].strip() for line in head.splitlines())
    first = next((line for line in lines if line and not line.startswith(b"%")), b"").replace(b",", b" ").split()
    try:
        _ = [float(cell) for cell in first]
    except ValueError:
        return 0
    return len(first)


def trajectory_table(path: Path, times: Path | None = None, near: int | None = None) -> LocalTrack | Reference:
    """Return the trajectory of a table without a header.

    Args:
        path: the table.
        times: file with one time (s) for each of KITTI's poses; None: ``times.txt`` beside the poses.
        near: ns since 1970, a time of the same drive: the week of times of week whose week is not stated.

    Raises:
        UsageError: the rows have another number of columns, or the times of the poses are missing.
        UnreadableLogError: rows that are no trajectory.
    """
    rows = _numbers(path)
    if times is not None and rows.shape[1] != KITTI:
        raise UsageError(
            f"{path}: only poses of KITTI need --truth-times; the file states its own times, so leave it out"
        )
    if rows.shape[1] == TUM:
        time, kept = _rising(path, _nanoseconds(path, rows[:, 0]))
        rows = rows[kept]
        quaternion = rows[:, [7, 4, 5, 6]]
        if not (np.abs(np.linalg.norm(quaternion, axis=1) - 1) < UNIT).all():
            raise UnreadableLogError(
                f"{path}: the last four of eight numbers are no quaternion of length 1; a TUM trajectory has the columns time x "
                "y z qx qy qz qw"
            )
        return LocalTrack(path.name, time, rows[:, 1:4], rotation_of_quaternion(quaternion))
    if rows.shape[1] == KITTI:
        return _kitti(path, rows, times)
    if rows.shape[1] == KF_GINS:
        return _kf_gins(path, rows, near)
    raise UsageError(
        f"{path}: its rows have {rows.shape[1]} numbers and no header line; TUM has 8, a pose of KITTI 12 and a row of KF-GINS 11; "
        "any other table needs a header line such as time_s,latitude_deg,longitude_deg,height_m"
    )


def _numbers(path: Path) -> Floats:
    comma = b"," in path.read_bytes()[:HEAD].split(b"\n", 1)[0]
    try:
        rows = np.loadtxt(path, comments=("#", "%"), delimiter="," if comma else None, ndmin=2, encoding="utf-8")
    except (ValueError, UnicodeDecodeError) as error:
        raise UnreadableLogError(
            f"{path}: a row is not like the others: {error}; remove it, or save the file again"
        ) from error
    finite = np.isfinite(rows).all(axis=1)
    if finite.sum() < 2:  # noqa: PLR2004 - a trajectory has two ends
        raise UnreadableLogError(f"{path}: {int(finite.sum())} rows of finite numbers; a trajectory needs two")
    return rows[finite]


def _nanoseconds(path: Path, seconds: Floats) -> Integers:
    if not (np.abs(seconds) < LATEST).all():
        raise UnreadableLogError(
            f"{path}: its first column is no time in seconds: it has {seconds[np.argmax(np.abs(seconds))]:.6g}"
        )
    whole = np.floor(seconds)
    return whole.astype(np.int64) * SECOND + np.rint((seconds - whole) * SECOND).astype(np.int64)


def _rising(path: Path, time: Integers) -> tuple[Integers, Integers]:
    """Return rising times, and their rows; of equal times the first is kept."""
    time, rows = np.unique(time, return_index=True)
    if time.size < 2:  # noqa: PLR2004 - a trajectory has two ends
        raise UnreadableLogError(f"{path}: all rows have the same time; a trajectory needs two times")
    return time, rows


def _kitti(path: Path, rows: Floats, times: Path | None) -> LocalTrack:
    beside = path.with_name(TIMES)
    if times is None and not beside.is_file():
        raise UsageError(
            f"{path}: poses of KITTI have no times; name a file that has one time (s) for each pose with --truth-times, or put "
            f"it beside the poses as {TIMES}"
        )
    stamps = _numbers(times or beside)
    if stamps.shape != (len(rows), 1):
        raise UsageError(
            f"{times or beside}: it has {len(stamps)} rows of {stamps.shape[1]} numbers; the poses need {len(rows)} rows of one time (s)"
        )
    poses = rows.reshape(-1, 3, 4)
    rotation = poses[:, :, :3]
    if not (np.abs(rotation @ np.swapaxes(rotation, 1, 2) - np.eye(3)) < UNIT).all():
        raise UnreadableLogError(
            f"{path}: twelve numbers in a row that are no rotation and position; a pose of KITTI is a 3 x 4 matrix, row by row"
        )
    time, kept = _rising(path, _nanoseconds(path, stamps[:, 0]))
    return LocalTrack(path.name, time, poses[kept, :, 3], rotation[kept])


def _kf_gins(path: Path, rows: Floats, near: int | None) -> Reference:
    week, second = rows[:, 0], rows[:, 1]
    sound = (np.abs(rows[:, 2]) <= 90) & (np.abs(rows[:, 3]) <= 180) & (second >= 0) & (second < 2 * WEEK)  # noqa: PLR2004 - deg
    if not sound.all() or (week != np.rint(week)).any():
        raise UnreadableLogError(
            f"{path}: eleven numbers in a row that are no navigation of KF-GINS: week, time of week (s), latitude, longitude "
            "(deg), height (m), velocity NED (m/s), roll, pitch, heading (deg)"
        )
    zero = _zero(int(week[0]), near)
    time, kept = _rising(path, zero + np.rint((week - week[0]) * WEEK * SECOND + second * SECOND).astype(np.int64))
    rows = rows[kept]
    sigmas = _kf_gins_sigmas(path, second[kept])
    return Reference(
        path.name, time, np.column_stack([np.radians(rows[:, 2:4]), rows[:, 4]]), rows[:, 5:8], np.radians(rows[:, 8:11]),
        Origin("deg, m, m/s", "NED", "unix" if zero else "log"), *sigmas,
    )  # fmt: skip


def _zero(week: int, near: int | None) -> int:
    """Return the start of a GPS week, ns since 1970 UTC; of the week of ``near`` if the file states none; 0: unknown."""
    start = GPS_EPOCH + timedelta(weeks=week)
    if week <= 0:
        if near is None or near < UNIX:
            return 0
        start = GPS_EPOCH + (UNIX_EPOCH + timedelta(seconds=near / SECOND) - GPS_EPOCH) // timedelta(
            weeks=1
        ) * timedelta(weeks=1)
    return round((start - UNIX_EPOCH).total_seconds() - ahead_of_utc(start)) * SECOND


def _kf_gins_sigmas(path: Path, second: Floats) -> tuple[Floats | None, Floats | None, Floats | None]:
    """Return the sigmas of position, velocity and attitude from the file of standard deviations, if it is there."""
    beside = path.with_name(f"{path.stem.replace('Navresult', 'STD')}.txt")
    if beside.name == path.name or not beside.is_file():
        return None, None, None
    rows = _numbers(beside)
    if rows.shape[1] < 10 or rows[-1, 0] < second[0] or rows[0, 0] > second[-1]:  # noqa: PLR2004 - time and nine sigmas
        raise UnreadableLogError(
            f"{beside}: it lies beside {path.name}, but is no table of its standard deviations: time and nine sigmas; rename it"
        )
    at = np.stack([np.interp(second, rows[:, 0], rows[:, i]) for i in range(1, 10)], axis=1)
    return at[:, :3], at[:, 3:6], np.radians(at[:, 6:])

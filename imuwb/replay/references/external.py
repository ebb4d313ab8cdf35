"""Trajectories from other files: on the clock of the log, on the Earth, and as references of the IMU."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.errors import MissingDataError, UsageError
from imuwb.geodesy import euler_of_rotation, ned_scale
from imuwb.geodesy.local_track import LocalTrack, RigidFit, rigid_fit
from imuwb.geodesy.tangent_plane import ned_of, position_of, turn_between
from imuwb.log import SECOND, GnssStream, Log, Origin, Reference
from imuwb.notes import Note

FEWEST = 10  #: fixes to which a trajectory in a frame of its own is fitted
NARROW = 3.0  #: a track is too straight for a fit if its width is below this many times the distances that remain ...
NARROWEST = 1.0  #: ... or below this, m
APART = 10.0, 0.05  #: m, and share of the track's extent; a fit that leaves more is refused
MOVING = 1.5  #: m/s; a faster vehicle shows its course
LEVEL = 0.7  #: least mean cosine between the body's down axis and down
COURSE = np.radians(30)  #: largest median difference between heading and course
#: body axes -> matrix that turns vectors in forward-right-down into these axes
BODIES = {
    "forward-right-down": np.eye(3),
    "forward-left-up": np.diag([1.0, -1.0, -1.0]),
    "right-down-forward": np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]),
}
#: axes of a frame -> matrix that turns vectors in it into north-east-down
AXES = {"ned": np.eye(3), "enu": np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])}


@dataclass(frozen=True, slots=True)
class Placing:
    """Where a trajectory of another file is: its clock, its point of the vehicle, and the place of its frame on the Earth."""

    delay: float = 0.0  #: s, by which its stamps are late
    lever_arm: tuple[float, float, float] = (0.0, 0.0, 0.0)  #: m FRD, from the IMU to its point
    origin: tuple[float, float, float] | None = None  #: deg, deg, m; None: the frame is fitted to the fixes
    axes: Literal["ned", "enu"] = "enu"  #: of the frame, if its origin is given


def external_reference(
    found: Log | LocalTrack | Reference, log: Log, gnss: GnssStream, placing: Placing, option: str, name: str | None = None
) -> tuple[Reference, tuple[Note, ...]]:  # fmt: skip
    """Return a trajectory of another file as a reference on the clock of a log, and notes on how it was placed.

    Args:
        found: what was read from the file.
        log: the log.
        gnss: the log's receiver, to whose fixes a trajectory in a frame of its own is fitted.
        placing: clock and place.
        option: beginning of the names of the options in messages, such as "truth".
        name: for the result; None: the name in the file.

    Raises:
        MissingDataError: the file has no trajectory, or none within the log's time.
        UsageError: a trajectory in a frame of its own cannot be fitted to the fixes.
    """
    chosen, notes = _of_log(found, option) if isinstance(found, Log) else (found, list[Note]())
    if isinstance(chosen, LocalTrack):
        moved = replace(chosen, time=_on_clock(chosen.time, log, placing.delay, chosen.name, option))
        reference, note = _placed(moved, log, gnss, placing, option)
        return replace(reference, name=name or reference.name, lever_arm=placing.lever_arm), (*notes, note)
    if placing.origin is not None:
        raise UsageError(f"{chosen.name}: it has latitude and longitude, so leave --{option}-origin out")
    time = _on_clock(chosen.time, log, placing.delay, chosen.name, option)
    return replace(chosen, name=name or chosen.name, time=time, lever_arm=placing.lever_arm), tuple(notes)


def _of_log(found: Log, option: str) -> tuple[Reference | LocalTrack, list[Note]]:
    """Return the trajectory of a log: its reference, its best receiver, or its odometry; a solution is rather an odometry."""
    path = found.provenance.path
    receivers = sorted(found.gnss, key=lambda g: (g.velocity is None, g.position_sigma is None, -len(g)))
    fixes: list[Reference | LocalTrack] = [reference_of_receiver(g) for g in receivers]
    poses: list[Reference | LocalTrack] = [pose for pose in found.poses if pose.time.size]
    references = sorted(found.references, key=lambda r: r.origin.by_filter)
    streams = [*references, *poses, *fixes] if option == "solution" else [*references, *fixes, *poses]
    if not streams:
        raise MissingDataError(
            f"{path}: it has no trajectory: neither a reference nor positions of a receiver; a table needs the columns "
            "time, latitude, longitude and height"
        )
    others = [stream.name for stream in streams[1:]]
    return streams[0], [_chosen(path, streams[0].name, others)] if others else []


def _chosen(path: str, name: str, others: list[str]) -> Note:
    return Note("trajectory-chosen", f"{path}: {name} is used; {path}#NAME uses another one: {', '.join(others)}")


def reference_of_receiver(gnss: GnssStream) -> Reference:
    """Return the positions of a receiver in three dimensions as a reference, with its velocities if most positions have one."""
    rows = np.isfinite(gnss.position).all(axis=1)
    if gnss.fix_type is not None and (gnss.fix_type >= 3).any():  # noqa: PLR2004 - MAVLink: 3D
        rows &= gnss.fix_type >= 3  # noqa: PLR2004
    velocity = None
    if gnss.velocity is not None:
        known = np.asarray(np.isfinite(gnss.velocity[:, :2]).all(axis=1))
        if (rows & known).sum() > max(1, rows.sum() / 2):
            rows = rows & known
            velocity = gnss.velocity[rows].copy()
            lacking = np.isnan(velocity[:, 2])
            climb = np.gradient(gnss.position[rows, 2], gnss.time[rows] / SECOND)
            velocity[lacking, 2] = -climb[lacking]

    def kept(values: Floats | None) -> Floats | None:
        return None if values is None else values[rows]

    return Reference(
        gnss.name, gnss.time[rows], gnss.position[rows], velocity, None, gnss.origin, kept(gnss.position_sigma),
        kept(gnss.velocity_sigma) if velocity is not None else None,
    )  # fmt: skip


def _span(log: Log) -> tuple[int, int]:
    triads = [t for imu in log.imus[:1] for t in (imu.angular_rate, imu.specific_force) if t is not None and len(t)]
    return max(int(t.time[0]) for t in triads), min(int(t.time[-1]) for t in triads)


def _on_clock(time: Integers, log: Log, delay: float, name: str, option: str) -> Integers:
    """Return times without their delay; they must meet the log."""
    if not time.size:
        raise MissingDataError(f"{name}: the trajectory has no row that can be used")
    moved = time - round(delay * SECOND)
    first, last = _span(log)
    if moved[0] > last or moved[-1] < first:
        begin, end = (float(moved[0]) / SECOND, float(moved[-1]) / SECOND)
        raise MissingDataError(
            f"{name}: none of its times lies within the log's: it runs from {begin:.3f} s to {end:.3f} s, and the IMU from "
            f"{first / SECOND:.3f} s to {last / SECOND:.3f} s of its clock; if both began together, --{option}-delay "
            f"{delay + (float(moved[0]) - first) / SECOND:.3f} brings them together"
        )
    return moved


def _placed(
    track: LocalTrack, log: Log, gnss: GnssStream, placing: Placing, option: str
) -> tuple[Reference, Note]:  # fmt: skip
    """Return a trajectory in a frame of its own as a reference, and how it came to its place."""
    if placing.origin is not None:
        latitude, longitude, height = placing.origin
        origin = np.array([np.radians(latitude), np.radians(longitude), height])
        turn, shift = AXES[placing.axes], np.zeros(3)
        text = f"{track.name}: its frame begins at {latitude:g}, {longitude:g} deg, {height:g} m, with axes {placing.axes.upper()}"
    else:
        origin, fit, count = _fitted(track, gnss, option)
        turn, shift = fit.rotation, fit.shift
        text = (
            f"{track.name}: its frame is fitted to {count} fixes of {gnss.name} by a rotation and a shift; distances of "
            f"{fit.rms:.2f} m (root mean square) remain; an offset that all fixes have in common is not seen"
        )
    sigma = None if track.position_sigma is None else np.sqrt(np.square(track.position_sigma) @ np.square(turn).T)
    position = position_of(track.position @ turn.T + shift, origin)
    there = turn_between(position, origin) @ turn  # from the frame to the axes of each place
    velocity = None if track.velocity is None else np.einsum("nij,nj->ni", there, track.velocity)
    attitude = _attitude(track, there, position)
    if attitude is None and track.rotation is not None:
        text += "; its attitude fits neither the course nor level, and is not used"
    epoch = log.imu().origin.epoch
    return Reference(track.name, track.time, position, velocity, attitude, Origin("m", "NED", epoch), sigma), Note(
        "placed", text
    )


def _fitted(track: LocalTrack, gnss: GnssStream, option: str) -> tuple[Floats, RigidFit, int]:
    """Return the origin and the rotation and shift that bring a track to the fixes, and the number of fixes."""
    good = np.isfinite(gnss.position).all(axis=1) & (gnss.time >= track.time[0]) & (gnss.time <= track.time[-1])
    if gnss.fix_type is not None:
        good &= gnss.fix_type >= 3  # noqa: PLR2004 - MAVLink: 3D
    state = "give it with latitude, longitude and height"
    if option == "truth":
        state = "state its place with --truth-origin LAT,LON,HEIGHT and --truth-axes"
    if good.sum() < FEWEST:
        raise MissingDataError(
            f"{track.name}: {int(good.sum())} fixes of {gnss.name} lie within its time; a fit of its frame needs {FEWEST}; {state}"
        )
    origin, fixes = gnss.position[good][0], gnss.position[good]
    ned = ned_of(fixes, origin)
    zero = gnss.time[good][0]
    at = (gnss.time[good] - zero) / SECOND
    points = np.stack([np.interp(at, (track.time - zero) / SECOND, track.position[:, i]) for i in range(3)], axis=1)
    fit = rigid_fit(points, ned)
    # A few bad fixes do not count: the fit is made again with those that are near.
    distance = np.linalg.norm(points @ fit.rotation.T + fit.shift - ned, axis=1)
    near = distance <= NARROW * max(float(np.median(distance)), 1e-3)
    if near.sum() >= FEWEST:
        fit = rigid_fit(points[near], ned[near])
    extent = float(np.ptp(ned[:, :2], axis=0).max())
    if fit.rms > max(APART[0], APART[1] * extent):
        raise UsageError(
            f"{track.name}: it does not fit the fixes of {gnss.name}: distances of {fit.rms:.1f} m (root mean square) remain on a "
            f"track of {extent:.0f} m; check that it belongs to this log, and its --{option}-delay; or {state}"
        )
    if fit.width < max(NARROWEST, NARROW * fit.rms):
        raise UsageError(
            f"{track.name}: the track is too straight for a fit of its frame: it is {fit.width:.1f} m wide, and {fit.rms:.1f} m "
            f"remain; {state}"
        )
    return origin, fit, int(near.sum())


def _attitude(track: LocalTrack, turn: Floats, position: Floats) -> Floats | None:
    """Return roll, pitch and heading in those body axes that are level and point along the course; None: no axes do.

    Args:
        track: with rotations from the body to its frame.
        turn: (n, 3, 3) from the frame to north, east and down.
        position: (n, 3) latitude rad, longitude rad, height m.
    """
    if track.rotation is None:
        return None
    seconds = (track.time - track.time[0]) / SECOND
    velocity = np.gradient(position, seconds, axis=0) * ned_scale(position[:, 0], position[:, 2])
    moving = np.hypot(velocity[:, 0], velocity[:, 1]) > MOVING
    course = np.arctan2(velocity[:, 1], velocity[:, 0])
    for body in BODIES.values():
        rotation = turn @ track.rotation @ body
        off = euler_of_rotation(rotation)[:, 2] - course
        ahead = not moving.any() or np.median(np.abs(np.angle(np.exp(1j * off[moving])))) < COURSE
        if rotation[:, 2, 2].mean() > LEVEL and ahead:
            return euler_of_rotation(rotation)
    return None

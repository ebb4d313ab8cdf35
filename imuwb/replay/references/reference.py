"""The reference against which drift is measured: truth, RTK-fixed positions, a filter's run over all fixes, or the vehicle's own."""

from dataclasses import dataclass, replace

import numpy as np

from imuwb.arrays import Floats
from imuwb.errors import UsageError
from imuwb.geodesy.attitude import rotation_of_euler
from imuwb.geodesy.earth import ned_scale
from imuwb.log import SECOND, GnssStream, Log, Reference
from imuwb.navigation.filter import Solution
from imuwb.navigation.smoother import smoothed

FIXED = 6  #: fix type: carrier phases with integer ambiguities
LEAST = 2  #: fewest points of a reference
GAP = 3.0  #: s; longer gaps of the reference are not interpolated
FIXED_SIGMA = 0.02  #: m, of fixed positions without sigmas
MOST = 0.5  #: share of fixed positions above which a receiver is a reference


@dataclass(frozen=True, eq=False, slots=True)
class ReferenceTrack:
    """A trajectory of the IMU, as functions of time."""

    name: str
    kind: str  #: "truth", "fixed", "smoothed", "own", or "estimate": of the vehicle's own filter
    time: Floats  #: (n,) s from the log's start
    position: Floats  #: (n, 3) latitude rad, longitude rad, height m
    velocity: Floats  #: (n, 3) m/s, NED
    heading: Floats | None  #: (n,) rad, without jumps; None: unknown
    sigma: Floats  #: (n, 3) m NED
    velocity_stated: bool = True  #: whether the velocity is a value of its own; else it follows from the positions

    def __post_init__(self) -> None:
        """Keep the last of several points of one time: an IMU slower than its receiver has several fixes at one sample.

        Raises:
            ValueError: fewer than two points, of which no trajectory can be made.
        """
        last = np.append(np.diff(self.time) > 0, self.time.size > 0)
        if np.count_nonzero(last) < LEAST:
            raise ValueError(
                f"the reference, {self.name}, has {np.count_nonzero(last)} points with position and velocity within the filter's "
                f"time; a reference needs {LEAST}; choose another --reference"
            )
        for part in ("time", "position", "velocity", "heading", "sigma"):
            values = getattr(self, part)
            object.__setattr__(self, part, None if values is None else values[last])

    def __repr__(self) -> str:
        """Return name, kind and time in a line."""
        return f"Reference: {self.name} ({self.kind}), {self.time.size} points, {self.time[0]:.1f} s to {self.time[-1]:.1f} s"

    def at(self, time: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """Return position, velocity, heading and position sigma at some times; positions are nan outside and in gaps.

        Args:
            time: (...,) s from the log's start.
        """
        rates = self.velocity / ned_scale(self.position[:, 0], self.position[:, 2])
        position = _between(self.time, self.position, rates, np.asarray(time, dtype=np.float64))
        velocity = np.stack([np.interp(time, self.time, self.velocity[:, i]) for i in range(3)], axis=-1)
        sigma = np.stack([np.interp(time, self.time, self.sigma[:, i]) for i in range(3)], axis=-1)
        heading = np.full(np.shape(time), np.nan) if self.heading is None else np.interp(time, self.time, self.heading)
        after = np.clip(np.searchsorted(self.time, time), 1, self.time.size - 1)
        far = (self.time[after] - self.time[after - 1] > GAP) | (time < self.time[0]) | (time > self.time[-1])
        return np.where(far[..., None], np.nan, position), velocity, heading, sigma


def reference_names(log: Log, wanted: str = "best") -> tuple[str, ...]:
    """Return the references that are tried in their order: those that the log has for "best", else the wanted one."""
    if wanted != "best":
        return (wanted,)
    there = {"truth": truth_of(log) is not None, "fixed": any(map(_is_fixed, log.gnss)), "smoothed": True}
    return tuple(name for name, is_there in there.items() if is_there)


def reference_track(log: Log, solution: Solution, wanted: str = "best") -> ReferenceTrack:
    """Return the wanted reference of a log; the best one is truth, then RTK-fixed positions, then a filter's smoothed run.

    Args:
        log: with its references and receivers.
        solution: a filter's run over the whole log. Its attitude relates antenna and IMU. If the
            reference is its smoothed run, it must come from ``solve(..., smooth=True)``.
        wanted: "best", "truth", "fixed", "smoothed", "own": the run, not smoothed; "ekf": the estimate of the vehicle's own
            filter; or the name of a reference of the log.

    Raises:
        ValueError: the log lacks the wanted reference.
        UsageError: there is no reference of that name.
    """
    truth, fixed = truth_of(log), next((g for g in log.gnss if _is_fixed(g)), None)
    if truth is not None and wanted in ("best", "truth"):
        return _given(log, truth, solution)
    if fixed is not None and wanted in ("best", "fixed"):
        return _fixed(log, fixed, solution)
    if wanted in ("best", "smoothed"):
        return _smoothed(solution)
    if wanted == "own":
        return own_track(solution)
    for reference in log.references:
        if wanted == reference.name or (wanted == "ekf" and reference.origin.by_filter):
            return _given(log, reference, solution)
    reasons = {
        "truth": "the log has no reference trajectory; name a file with --truth, or choose another --reference",
        "fixed": "no receiver of the log has RTK-fixed positions with velocities; choose another --reference",
        "ekf": "the log has no estimate of the vehicle's own filter; choose another --reference",
    }
    check_reference(log, wanted)
    raise ValueError(reasons[wanted])


def check_reference(log: Log, wanted: str) -> None:
    """Raise UsageError unless a name is a kind of reference, or a reference of the log."""
    kinds = ("best", "truth", "fixed", "smoothed", "own", "ekf")
    names = tuple(dict.fromkeys((*kinds, *(r.name for r in log.references))))
    if wanted not in names:
        raise UsageError(f"--reference {wanted}: there is no such reference; choose among {', '.join(names)}")


def own_track(solution: Solution) -> ReferenceTrack:
    """Return a filter's own run without outages (Quinchia, section 7)."""
    return ReferenceTrack(
        f"{solution.model.name} without outage", "own", solution.time, solution.position, solution.velocity,
        np.unwrap(solution.euler[:, 2]), solution.sigma[:, :3],
    )  # fmt: skip


def _smoothed(solution: Solution) -> ReferenceTrack:
    track = smoothed(solution)
    return ReferenceTrack(
        f"{solution.model.name}, all fixes, smoothed", "smoothed", track.time, track.position, track.velocity,
        np.unwrap(track.euler[:, 2]), track.sigma[:, :3],
    )  # fmt: skip


def truth_of(log: Log) -> Reference | None:
    """Return the first reference of a log that is not an estimate of the vehicle's own filter."""
    return next((r for r in log.references if not r.origin.by_filter), None)


def given_track(log: Log, reference: Reference) -> ReferenceTrack:
    """Return a reference on the log's clock; its velocity follows from its positions if it states none; unknown sigmas are 0.

    Raises:
        ValueError: the reference has fewer than two rows.
    """
    time = (reference.time - (log.zero or 0)) / SECOND
    if time.size < 2:  # noqa: PLR2004 - a track has two ends
        raise ValueError(f"{reference.name} has {time.size} rows; a reference needs two")
    heading = None if reference.attitude is None else np.unwrap(reference.attitude[:, 2])
    velocity = reference.velocity
    if velocity is None:
        scale = ned_scale(reference.position[:, 0], reference.position[:, 2])
        velocity = np.gradient(reference.position, time, axis=0) * scale
    sigma = np.zeros((time.size, 3)) if reference.position_sigma is None else np.nan_to_num(reference.position_sigma)
    kind, name = "truth", reference.name
    if reference.origin.by_filter:
        kind, name = "estimate", f"{name}, an estimate of the vehicle's own filter"
    return ReferenceTrack(
        name, kind, time, reference.position, velocity, heading, sigma, reference.velocity is not None
    )


def _given(log: Log, reference: Reference, solution: Solution) -> ReferenceTrack:
    """Return a reference of the log, moved to the IMU by its own attitude or, without one, the filter's."""
    track = given_track(log, reference)
    if not any(reference.lever_arm):
        return track
    euler = reference.attitude
    if euler is None:
        inside = (track.time >= solution.time[0]) & (track.time <= solution.time[-1])
        time, position, velocity, sigma = (
            part[inside] for part in (track.time, track.position, track.velocity, track.sigma)
        )
        track = replace(track, time=time, position=position, velocity=velocity, sigma=sigma)
        euler = _euler_at(solution, time)
    position = track.position - _arm(euler, reference.lever_arm) / ned_scale(track.position[:, 0], track.position[:, 2])
    return replace(track, position=position)


def _euler_at(solution: Solution, time: Floats) -> Floats:
    return np.stack([np.interp(time, solution.time, np.unwrap(solution.euler[:, i])) for i in range(3)], axis=1)


def _arm(euler: Floats, lever_arm: tuple[float, float, float]) -> Floats:
    """Return a lever arm in north-east-down, (n, 3) m."""
    return rotation_of_euler(euler) @ np.array(lever_arm)


def _is_fixed(gnss: GnssStream) -> bool:
    return gnss.fix_type is not None and gnss.velocity is not None and bool((gnss.fix_type == FIXED).mean() > MOST)


def _fixed(log: Log, gnss: GnssStream, solution: Solution) -> ReferenceTrack:
    """Return the fixed positions of an antenna, moved to the IMU by the filter's attitude."""
    time = (gnss.time - (log.zero or 0)) / SECOND - solution.model.installation.gnss_delay
    velocity = np.zeros((time.size, 3)) if gnss.velocity is None else gnss.velocity
    kept = np.isfinite(velocity[:, :2]).all(axis=1) & (time >= solution.time[0]) & (time <= solution.time[-1])
    if gnss.fix_type is not None:
        kept &= gnss.fix_type == FIXED
    time, position, velocity = time[kept], gnss.position[kept], velocity[kept].copy()
    lacking = np.isnan(velocity[:, 2])
    if lacking.any() and time.size > 1:
        velocity[lacking, 2] = -np.gradient(position[:, 2], time)[lacking]
    arm = _arm(_euler_at(solution, time), solution.model.installation.lever_arm)
    position = position - arm / ned_scale(position[:, 0], position[:, 2])
    sigma = np.full((time.size, 3), FIXED_SIGMA)
    if gnss.position_sigma is not None:
        sigma = np.nan_to_num(gnss.position_sigma[kept], nan=FIXED_SIGMA)
    return ReferenceTrack(f"RTK-fixed positions of {gnss.name}", "fixed", time, position, velocity, None, sigma)


def _between(at: Floats, value: Floats, rate: Floats, time: Floats) -> Floats:
    """Return the cubic Hermite polynomials through values and rates, (..., 3), at some times; nan outside."""
    low = np.clip(np.searchsorted(at, time, side="right") - 1, 0, at.size - 2)
    x = ((time - at[low]) / (at[low + 1] - at[low]))[..., None]
    step = (at[low + 1] - at[low])[..., None]
    start = (1 + 2 * x) * (1 - x) ** 2 * value[low] + x * (1 - x) ** 2 * step * rate[low]
    end = x**2 * (3 - 2 * x) * value[low + 1] + x**2 * (x - 1) * step * rate[low + 1]
    return np.where((x >= 0) & (x <= 1), start + end, np.nan)

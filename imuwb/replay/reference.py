"""The reference against which drift is measured: truth, RTK-fixed positions, or a filter's run over all fixes."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from imuwb.arrays import Floats
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
    kind: str  #: "truth", "fixed", "smoothed" or "own"
    time: Floats  #: (n,) s from the log's start
    position: Floats  #: (n, 3) latitude rad, longitude rad, height m
    velocity: Floats  #: (n, 3) m/s, NED
    heading: Floats | None  #: (n,) rad, without jumps; None: unknown
    sigma: Floats  #: (n, 3) m NED

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

    def __str__(self) -> str:
        """Return name, kind and time in a line."""
        return f"Reference: {self.name} ({self.kind}), {self.time.size} points, {self.time[0]:.1f} s to {self.time[-1]:.1f} s"

    __repr__ = __str__

    def at(self, time: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """Return position, velocity, heading and position sigma at some times; positions are nan outside and in gaps.

        Args:
            time: (...,) s from the log's start.
        """
        rates = self.velocity / ned_scale(self.position[:, 0], self.position[:, 2])
        position = CubicHermiteSpline(self.time, self.position, rates, extrapolate=False)(time)
        velocity = np.stack([np.interp(time, self.time, self.velocity[:, i]) for i in range(3)], axis=-1)
        sigma = np.stack([np.interp(time, self.time, self.sigma[:, i]) for i in range(3)], axis=-1)
        heading = np.full(np.shape(time), np.nan) if self.heading is None else np.interp(time, self.time, self.heading)
        after = np.clip(np.searchsorted(self.time, time), 1, self.time.size - 1)
        far = (self.time[after] - self.time[after - 1] > GAP) | (time < self.time[0]) | (time > self.time[-1])
        return np.where(far[..., None], np.nan, position), velocity, heading, sigma


def needs_smoothing(log: Log, wanted: str = "best") -> bool:
    """Return whether the wanted reference is a smoothed run of a filter."""
    if wanted == "best":
        return _truth_of(log) is None and not any(_is_fixed(g) for g in log.gnss)
    return wanted == "smoothed"


def reference_track(log: Log, solution: Solution, wanted: str = "best") -> ReferenceTrack:
    """Return the wanted reference of a log; the best one is truth, then RTK-fixed positions, then a filter's smoothed run.

    Args:
        log: with its references and receivers.
        solution: a filter's run over the whole log. Its attitude relates antenna and IMU. If the
            reference is its smoothed run, it must come from ``solve(..., smooth=True)``.
        wanted: "best", "truth", "fixed", "smoothed", or "own": the run, not smoothed.

    Raises:
        ValueError: the log lacks the wanted reference.
    """
    truth, fixed = _truth_of(log), next((g for g in log.gnss if _is_fixed(g)), None)
    if truth is not None and wanted in ("best", "truth"):
        return _truth(log, truth)
    if fixed is not None and wanted in ("best", "fixed"):
        return _fixed(log, fixed, solution)
    if wanted in ("best", "smoothed"):
        return _smoothed(solution)
    if wanted == "own":
        return own_track(solution)
    raise ValueError(
        {
            "truth": "the log has no reference trajectory with velocities; choose another --reference",
            "fixed": "no receiver of the log has RTK-fixed positions with velocities; choose another --reference",
        }[wanted]
    )


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


def _truth_of(log: Log) -> Reference | None:
    return next((r for r in log.references if r.velocity is not None), None)


def _truth(log: Log, reference: Reference) -> ReferenceTrack:
    time = (reference.time - (log.zero or 0)) / SECOND
    heading = None if reference.attitude is None else np.unwrap(reference.attitude[:, 2])
    velocity = np.zeros((time.size, 3)) if reference.velocity is None else reference.velocity
    return ReferenceTrack(
        reference.name, "truth", time, reference.position, velocity, heading, np.zeros((time.size, 3))
    )


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
    euler = np.stack([np.interp(time, solution.time, np.unwrap(solution.euler[:, i])) for i in range(3)], axis=1)
    arm = rotation_of_euler(euler) @ np.array(solution.model.installation.lever_arm)
    position = position - arm / ned_scale(position[:, 0], position[:, 2])
    sigma = np.full((time.size, 3), FIXED_SIGMA)
    if gnss.position_sigma is not None:
        sigma = np.nan_to_num(gnss.position_sigma[kept], nan=FIXED_SIGMA)
    return ReferenceTrack(f"RTK-fixed positions of {gnss.name}", "fixed", time, position, velocity, None, sigma)

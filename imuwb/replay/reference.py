"""What drift is measured against."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from imuwb.geodesy.attitude import rotation_of_euler
from imuwb.geodesy.earth import radii_of_curvature
from imuwb.log import SECOND
from imuwb.navigation.smoother import smoothed

if TYPE_CHECKING:
    from imuwb.log import Floats, GnssStream, Log, Reference
    from imuwb.navigation.filter import Solution

FIXED = 6  #: fix type: carrier phases with whole ambiguities
GAP = 3.0  #: s, over which no reference is interpolated


@dataclass(frozen=True, eq=False, slots=True)
class Yardstick:
    """A trajectory of the IMU that drift is measured against, as functions of time."""

    name: str
    kind: str  #: "truth", "fixed", "smoothed" or "own"
    time: Floats  #: (n,) s from the log's start
    position: Floats  #: (n, 3) latitude rad, longitude rad, height m
    velocity: Floats  #: (n, 3) m/s, NED
    heading: Floats | None  #: (n,) rad, unwrapped; None: not known
    sigma: Floats  #: (n, 3) m NED

    def at(self, time: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """Return position, velocity, heading and position sigma at some times; nan where there is no reference near.

        Args:
            time: (...,) s from the log's start.
        """
        spline = CubicHermiteSpline(self.time, self.position, _rates(self.position, self.velocity), extrapolate=False)
        position = spline(time)
        velocity = np.stack([np.interp(time, self.time, self.velocity[:, i]) for i in range(3)], axis=-1)
        sigma = np.stack([np.interp(time, self.time, self.sigma[:, i]) for i in range(3)], axis=-1)
        heading = np.full(np.shape(time), np.nan) if self.heading is None else np.interp(time, self.time, self.heading)
        behind = np.clip(np.searchsorted(self.time, time), 1, self.time.size - 1)
        far = (self.time[behind] - self.time[behind - 1] > GAP) | (time < self.time[0]) | (time > self.time[-1])
        position = np.where(far[..., None], np.nan, position)
        return position, velocity, heading, sigma


def _rates(position: Floats, velocity: Floats) -> Floats:
    meridian, transverse = radii_of_curvature(position[:, 0])
    return np.stack([
        velocity[:, 0] / (meridian + position[:, 2]),
        velocity[:, 1] / ((transverse + position[:, 2]) * np.cos(position[:, 0])),
        -velocity[:, 2],
    ], axis=1)  # fmt: skip


def is_independent(log: Log, wanted: str = "best") -> bool:
    """Return whether the reference that is wanted is in the log itself, or no filter need be smoothed for it."""
    if wanted == "best":
        return _reference(log) is not None or any(_is_fixed(g) for g in log.gnss)
    return wanted != "smoothed"


def yardstick(log: Log, solution: Solution, wanted: str = "best") -> Yardstick:
    """Return the best reference of a log: independent truth, RTK-fixed points, or a filter's run over all fixes, smoothed.

    Args:
        log: with its references and receivers.
        solution: a filter's run over the whole log: it tells the attitude, by which antenna and IMU differ, and is the last
            choice itself; then it must have been kept for smoothing.
        wanted: "best", "truth", "fixed", "smoothed" or "own" (as it is, not smoothed).

    Raises:
        ValueError: the log has not the one wanted.
    """
    truth, fixed = _reference(log), next((g for g in log.gnss if _is_fixed(g)), None)
    if truth is not None and wanted in ("best", "truth"):
        return _truth(log, truth)
    if fixed is not None and wanted in ("best", "fixed"):
        return _fixed(log, fixed, solution)
    if wanted in ("best", "smoothed"):
        return _smoothed(solution)
    if wanted == "own":
        return own(solution)
    message = {
        "truth": "the log holds no reference trajectory with velocities",
        "fixed": "no receiver of the log has RTK-fixed positions with velocities",
    }[wanted]
    raise ValueError(message)


def _reference(log: Log) -> Reference | None:
    return next((r for r in log.references if r.velocity is not None), None)


def _smoothed(solution: Solution) -> Yardstick:
    found = smoothed(solution)
    return Yardstick(
        f"{solution.model.name}, all fixes, smoothed", "smoothed", found.time, found.position, found.velocity,
        np.unwrap(found.euler[:, 2]), found.sigma[:, :3],
    )  # fmt: skip


def own(solution: Solution) -> Yardstick:
    """Return a filter's own run without outage (Quinchia, section 7)."""
    return Yardstick(
        f"{solution.model.name} without outage", "own", solution.time, solution.position, solution.velocity,
        np.unwrap(solution.euler[:, 2]), solution.sigma[:, :3],
    )  # fmt: skip


def _truth(log: Log, reference: Reference) -> Yardstick:
    time = (reference.time - (log.zero or 0)) / SECOND
    heading = None if reference.attitude is None else np.unwrap(reference.attitude[:, 2])
    velocity = np.zeros((time.size, 3)) if reference.velocity is None else reference.velocity
    return Yardstick(reference.name, "truth", time, reference.position, velocity, heading, np.zeros((time.size, 3)))


def _is_fixed(gnss: GnssStream) -> bool:
    return gnss.fix_type is not None and gnss.velocity is not None and bool((gnss.fix_type == FIXED).mean() > 0.5)  # noqa: PLR2004 - most


def _fixed(log: Log, gnss: GnssStream, solution: Solution) -> Yardstick:
    """Return fixed positions of the antenna, moved to the IMU by the filter's attitude."""
    time = (gnss.time - (log.zero or 0)) / SECOND - solution.model.installation.gnss_delay
    velocity = np.zeros((time.size, 3)) if gnss.velocity is None else gnss.velocity
    kept = np.isfinite(velocity).all(axis=1)
    if gnss.fix_type is not None:
        kept &= gnss.fix_type == FIXED
    kept &= (time >= solution.time[0]) & (time <= solution.time[-1])
    time, position, velocity = time[kept], gnss.position[kept], velocity[kept]
    euler = np.stack([np.interp(time, solution.time, np.unwrap(solution.euler[:, i])) for i in range(3)], axis=1)
    arm = rotation_of_euler(euler) @ np.array(solution.model.installation.lever_arm)
    meridian, transverse = radii_of_curvature(position[:, 0])
    position = position.copy()
    position[:, 0] -= arm[:, 0] / (meridian + position[:, 2])
    position[:, 1] -= arm[:, 1] / ((transverse + position[:, 2]) * np.cos(position[:, 0]))
    position[:, 2] += arm[:, 2]
    sigma = np.full((time.size, 3), 0.02)
    if gnss.position_sigma is not None:
        sigma = np.nan_to_num(gnss.position_sigma[kept], nan=0.02)
    return Yardstick(f"RTK-fixed points of {gnss.name}", "fixed", time, position, velocity, None, sigma)

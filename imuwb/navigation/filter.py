"""The filter over a whole log: from measurement, corrections and alignment to a solution with checkpoints."""

from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Booleans, Floats, Integers
from imuwb.errors import MissingDataError
from imuwb.geodesy.attitude import euler_of_quaternion
from imuwb.geodesy.earth import EARTH_RATE
from imuwb.navigation import kernel
from imuwb.navigation.alignment import Alignment
from imuwb.navigation.corrections import Corrections
from imuwb.navigation.covariance import NAVIGATION, flat
from imuwb.navigation.filter_model import FilterModel, receiver_variance
from imuwb.navigation.initial import axis_start
from imuwb.navigation.measurement import Measurement
from imuwb.navigation.strapdown import QUATERNION, SIZE, VELOCITY, navigation_state
from imuwb.navigation.tables import FIX, AxisTables, Marks, Prior, Rules, Track
from imuwb.navigation.workspace import workspace

ENDED = {
    kernel.NOT_FINITE: "a state or a variance is not a finite number",
    kernel.NOT_POSITIVE: "a variance is negative",
}


@dataclass(frozen=True, eq=False, slots=True)
class Solution:
    """A filter's run over a log: its state after each event, from the alignment on. There are m fixes and n error states."""

    model: FilterModel
    measurement: Measurement
    corrections: Corrections
    alignment: Alignment
    tables: AxisTables
    rules: Rules
    track: Track  #: by event; the events before the alignment have no state
    events: Integers  #: (m,) the events that are fixes, from the alignment on

    def __repr__(self) -> str:
        """Return the filter, the time, the fixes and the innovations in a line."""
        nis = self.fix_nis
        mean = f"{np.nanmean(nis / self.fix_dof):.2f}" if np.isfinite(nis).any() else "unknown"
        return (
            f"Solution of {self.model.name}: {self.events.size} fixes, {self.time[0]:.1f} s to {self.time[-1]:.1f} s, "
            f"NIS/dof {mean}, {self.refused} positions and velocities refused"
        )

    @property
    def time(self) -> Floats:
        """Return the time at which each fix is applied, (m,) s from the log's start: the end of its sample."""
        return self.measurement.time[self.corrections.events.at[self.events]]

    @property
    def position(self) -> Floats:
        """Return the positions of the IMU, (m, 3) latitude rad, longitude rad, height m."""
        return self.track.state[self.events, :3]

    @property
    def velocity(self) -> Floats:
        """Return the velocities of the IMU, (m, 3) m/s, NED."""
        return self.track.state[self.events, VELOCITY : VELOCITY + 3]

    @property
    def quaternion(self) -> Floats:
        """Return the attitudes, (m, 4) w, x, y, z, of the body relative to NED."""
        return self.track.state[self.events, QUATERNION : QUATERNION + 4]

    @property
    def euler(self) -> Floats:
        """Return the attitudes, (m, 3) roll, pitch, heading, rad."""
        return euler_of_quaternion(self.quaternion)

    @property
    def sigma(self) -> Floats:
        """Return the sigmas of all error states, (m, n)."""
        return np.sqrt(np.diagonal(self.track.covariance[self.events], axis1=1, axis2=2))

    @property
    def fix_nis(self) -> Floats:
        """Return the normalised innovations squared (NIS) of positions and velocities of the fixes after the alignment.

        Returns:
            (k, 2); nan where a fix has no position or no velocity.
        """
        after = np.arange(self.corrections.time.size) > self.alignment.event
        return self.track.nis[after & (self.corrections.events.kind == FIX)]

    @property
    def fix_dof(self) -> Floats:
        """Return the degrees of freedom of each NIS of ``fix_nis``, (k, 2): the measured parts; nan where there is none."""
        after = np.arange(self.corrections.time.size) > self.alignment.event
        measured = np.isfinite(self.track.innovation[after & (self.corrections.events.kind == FIX)])
        parts = np.stack([measured[:, :3].sum(axis=1), measured[:, 3:].sum(axis=1)], axis=1)
        return np.where(parts > 0, parts, np.nan)

    @property
    def used_nis(self) -> Floats:
        """Return ``fix_nis`` with nan where the gate refused a position or a velocity."""
        after = np.arange(self.corrections.time.size) > self.alignment.event
        return np.where(self.track.used[after & (self.corrections.events.kind == FIX)], self.fix_nis, np.nan)

    @property
    def refused(self) -> int:
        """Return how many positions and velocities of fixes the gate refused."""
        fixes = self.corrections.events.kind == FIX
        return int((np.isfinite(self.track.nis[fixes]) & ~self.track.used[fixes]).sum())

    def log_likelihood_of(self, first: int, last: int) -> float:
        """Return the composite log-likelihood of the innovations of some fixes: each component with its own sigma.

        Refused fixes count in full. A limit would make a filter the more likely, the more fixes it refuses.

        Args:
            first: row of the first fix in the receiver's stream.
            last: row of the last fix, included.
        """
        row = np.where(self.corrections.fix < 0, -1 - self.corrections.fix, self.corrections.fix)
        counted = (self.corrections.events.kind == FIX) & (row >= first) & (row <= last)
        return float(self.log_likelihoods(counted).sum())

    def log_likelihoods(self, counted: Booleans) -> Floats:
        """Return the composite log-likelihood of each event that counts, (c,).

        Args:
            counted: (E,) which events count.
        """
        innovation, deviation = self.track.innovation[counted], self.track.deviation[counted]
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.nansum(-0.5 * (innovation / deviation) ** 2 - np.log(deviation), axis=1)


def axis_errors(solution: Solution) -> tuple[Floats, Floats]:
    """Return the filter's estimates of the axes' errors at each fix, except scale factors, and their sigmas.

    Returns:
        (m, 6) and (m, 6), rad/s and m/s², ``gyro_x`` ... ``accel_z``.
    """
    tables, events = solution.tables, solution.events
    regime = solution.measurement.samples.regime[solution.corrections.events.at[events]]
    weight = np.where(tables.scale, 0.0, tables.step[regime])
    states, covariance = solution.track.axes[events], solution.track.covariance[events]
    errors, variance = np.zeros((2, events.size, 6))
    for axis in range(6):
        rows = slice(int(tables.first[axis]), int(tables.first[axis + 1]))
        place = slice(rows.start - NAVIGATION, rows.stop - NAVIGATION)
        own = weight[:, place]
        errors[:, axis] = (own * states[:, place]).sum(axis=1)
        variance[:, axis] = np.einsum("ei,eij,ej->e", own, covariance[:, rows, rows], own)
    return errors, np.sqrt(np.maximum(variance, 0.0))


def solve(
    model: FilterModel, measurement: Measurement, corrections: Corrections, alignment: Alignment,
    without: tuple[float, float] | None = None, *, smooth: bool = False,
) -> Solution:  # fmt: skip
    """Run a filter over a log.

    Args:
        model: the filter.
        measurement: the IMU.
        corrections: the events that correct the filter.
        alignment: where the filter starts.
        without: s from the log's start; fixes between these two times are not used.
        smooth: whether to keep what ``smoothed`` needs.

    Raises:
        MissingDataError: a state or a variance becomes invalid; the message states when.
        UsageError: a process that cannot be written with states, or too many of them.
    """
    tables, _ = model.tables(measurement.interval, measurement.celsius)
    if measurement.vibration:
        amplitude = np.square(measurement.vibration)[:, None] * np.repeat(model.vibration.white, 3)
        tables.white[:] += amplitude**2
    if measurement.gap_noise is not None:
        tables.white[-1] += measurement.gap_noise
    n = int(tables.first[6])
    state = navigation_state(alignment.position, alignment.velocity, alignment.euler)
    axes, covariance = _axes_at_start(model, measurement, tables, alignment)
    track = empty_track(corrections.events.at.size, n, smooth=smooth)
    first = alignment.event
    track.state[first], track.axes[first], track.covariance[first] = state, axes, covariance
    skip = (-1, -1) if without is None else tuple(int(np.searchsorted(measurement.time, t)) for t in without)
    rules, space = rules_of(model), workspace(n, transition=smooth)
    if smooth:
        space.transition[:] = flat(np.eye(n))
    ended, event = kernel.run(
        state, axes, flat(covariance), measurement.samples, corrections.events, rules, tables, space, alignment.sample,
        first + 1, skip[0], skip[1], no_marks(), track,
    )  # fmt: skip
    if ended != kernel.FINE:
        raise MissingDataError(
            f"{model.name}: at {corrections.time[event]:.1f} s {ENDED[ended]}: the model or its sigmas do not fit this log; "
            "imuwb model check shows what is unusual in an error model"
        )
    events = np.flatnonzero((corrections.fix >= 0) & (np.arange(corrections.fix.size) >= first))
    if without is not None:
        at = corrections.events.at[events]
        events = events[(at <= skip[0]) | (at >= skip[1])]
    return Solution(model, measurement, corrections, alignment, tables, rules, track, events)


def rules_of(model: FilterModel) -> Rules:
    """Return the rules of a whole run of a model."""
    settings = model.settings
    return Rules(
        settings.every,
        settings.gate,
        settings.patience,
        np.array(model.installation.lever_arm),
        np.array(model.installation.vehicle_arm),
    )


def no_marks() -> Marks:
    """Return empty marks: a run with them ends with its last event."""
    return Marks(np.zeros(0, np.int64), True, np.zeros((0, 10)), np.zeros((0, NAVIGATION, NAVIGATION)))


def empty_track(count: int, n: int, *, smooth: bool = False) -> Track:
    """Return an empty track with room for a run.

    Args:
        count: events.
        n: error states.
        smooth: whether to make room for what a smoother needs.
    """
    before = count if smooth else 0
    return Track(
        state=np.zeros((count, SIZE)), axes=np.zeros((count, n - NAVIGATION)), covariance=np.zeros((count, n, n)),
        innovation=np.full((count, 6), np.nan), deviation=np.full((count, 6), np.nan), nis=np.full((count, 2), np.nan),
        used=np.zeros((count, 2), dtype=np.bool_),
        before=Prior(
            np.zeros((before, SIZE)), np.zeros((before, n - NAVIGATION)), np.zeros((before, n, n)), np.zeros((before, n, n))
        ),
    )  # fmt: skip


def _axes_at_start(
    model: FilterModel, measurement: Measurement, tables: AxisTables, alignment: Alignment
) -> tuple[Floats, Floats]:
    """Return the axes' states at the alignment, (K,), and the covariance of all error states, (n, n).

    A gyro's mean over a standstill is a measurement of its error.
    """
    first = tables.first
    states, covariance = np.zeros(first[6] - NAVIGATION), np.zeros((first[6], first[6]))
    covariance[:NAVIGATION, :NAVIGATION] = alignment.covariance
    begin, end = alignment.standstill or (alignment.sample, alignment.sample)
    celsius = measurement.celsius[int(measurement.samples.regime[alignment.sample])]
    for axis, shaping in enumerate(model.shapings(measurement.interval, celsius)):
        place = slice(int(first[axis]), int(first[axis]) + shaping.order)
        if axis >= 3:  # noqa: PLR2004 - an accelerometer's mean is that of gravity, with an unknown tilt
            covariance[place, place] = axis_start(shaping, alignment.sample, 0, 0).covariance
        else:
            prior = axis_start(shaping, begin, end - begin, alignment.sample - end)
            covariance[place, place] = prior.covariance
            if end > begin:
                # On average over all attitudes, one axis has a third of the Earth's squared rate.
                noise = shaping.white / ((end - begin) * measurement.interval) + EARTH_RATE**2 / 3
                gain = prior.cross / (prior.variance + noise)
                states[place.start - NAVIGATION : place.stop - NAVIGATION] = gain * alignment.gyro_bias[axis]
                covariance[place, place] -= np.outer(gain, prior.cross)
        if model.scale_factor[axis // 3]:
            covariance[place.stop, place.stop] = model.scale_factor[axis // 3] ** 2
    if tables.receiver[0]:
        # The filter starts at a fix, so that the error of its position is the receiver's error plus white noise.
        for i, (s, variance) in enumerate(
            zip(tables.receiver, receiver_variance(model.settings.gnss_correlation[0]), strict=True)
        ):
            covariance[s, s] = covariance[i, s] = covariance[s, i] = variance
    return states, covariance

"""The filter over a whole log: from its measurement, corrections and start to a solution with checkpoints."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from imuwb.errors import MissingDataError
from imuwb.geodesy.attitude import euler_of_quaternion
from imuwb.geodesy.earth import EARTH_RATE
from imuwb.navigation import kernel
from imuwb.navigation.covariance import NAVIGATION, flat
from imuwb.navigation.initial import axis_start
from imuwb.navigation.strapdown import QUATERNION, SIZE, VELOCITY, navigation_state
from imuwb.navigation.tables import FIX, Marks, Prior, Rules, Track
from imuwb.navigation.workspace import workspace

if TYPE_CHECKING:
    from imuwb.log import Floats
    from imuwb.navigation.alignment import Alignment
    from imuwb.navigation.events import Corrections
    from imuwb.navigation.filter_model import FilterModel
    from imuwb.navigation.measurement import Measurement
    from imuwb.navigation.tables import AxisTables

ENDED = {
    kernel.NOT_FINITE: "a state or a variance is no number any more",
    kernel.NOT_POSITIVE: "a variance became negative",
}


@dataclass(frozen=True, eq=False, slots=True)
class Solution:
    """What a filter says behind each of its events, from its start on."""

    model: FilterModel
    moves: Measurement
    found: Corrections
    start: Alignment
    tables: AxisTables
    rules: Rules
    track: Track  #: by event; of events before the start: nothing
    events: np.ndarray[tuple[int], np.dtype[np.int64]]  #: (m,) the fixes among them, from the start on

    @property
    def time(self) -> Floats:
        """Return the times of the fixes, (m,) s from the log's start: of the sample at which each counts."""
        return self.moves.time[self.found.events.at[self.events]]

    @property
    def position(self) -> Floats:
        """Return (m, 3) latitude rad, longitude rad, height m, of the IMU."""
        return self.track.state[self.events, :3]

    @property
    def velocity(self) -> Floats:
        """Return (m, 3) m/s, NED."""
        return self.track.state[self.events, VELOCITY : VELOCITY + 3]

    @property
    def quaternion(self) -> Floats:
        """Return (m, 4) w, x, y, z, of the body to NED."""
        return self.track.state[self.events, QUATERNION : QUATERNION + 4]

    @property
    def euler(self) -> Floats:
        """Return (m, 3) roll, pitch, heading, rad."""
        return euler_of_quaternion(self.quaternion)

    @property
    def sigma(self) -> Floats:
        """Return (m, n) of all error states."""
        return np.sqrt(np.diagonal(self.track.covariance[self.events], axis1=1, axis2=2))

    @property
    def fix_nis(self) -> Floats:
        """Return the normalised innovations squared of positions and of velocities, (k, 2), of all fixes behind the start; nan: none."""
        behind = np.arange(self.found.time.size) > self.start.event
        return self.track.nis[behind & (self.found.events.kind == FIX)]

    @property
    def refused(self) -> int:
        """Return how many positions and velocities of fixes the gate kept out."""
        fixes = self.found.events.kind == FIX
        return int((np.isfinite(self.track.nis[fixes]) & ~self.track.used[fixes]).sum())

    def log_likelihood_of(self, first: int, last: int) -> float:
        """Return the log-likelihood of the innovations of the fixes between two rows of the receiver's, those refused at the gate."""
        row = np.where(self.found.fix < 0, -1 - self.found.fix, self.found.fix)
        counted = (self.found.events.kind == FIX) & (row >= first) & (row <= last)
        spread = self.track.deviation[counted]
        nis = np.minimum(self.track.nis[counted], self.rules.gate)
        return float(-np.nansum(nis) / 2 - np.log(spread[np.isfinite(spread)]).sum())


def axis_errors(solution: Solution) -> tuple[Floats, Floats]:
    """Return what a filter takes its axes' errors for at each fix, and the sigmas; scale factors left out.

    Returns:
        twice (m, 6) rad/s and m/s², ``gyro_x`` ... ``accel_z``.
    """
    tables, events = solution.tables, solution.events
    regime = solution.moves.samples.regime[solution.found.events.at[events]]
    weight = np.where(tables.scale, 0.0, tables.step[regime])
    states, covariance = solution.track.axes[events], solution.track.covariance[events]
    found, variance = np.zeros((events.size, 6)), np.zeros((events.size, 6))
    for axis in range(6):
        place = slice(int(tables.first[axis]) - NAVIGATION, int(tables.first[axis + 1]) - NAVIGATION)
        own = weight[:, place]
        found[:, axis] = (own * states[:, place]).sum(axis=1)
        behind = slice(place.start + NAVIGATION, place.stop + NAVIGATION)
        variance[:, axis] = np.einsum("ei,eij,ej->e", own, covariance[:, behind, behind], own)
    return found, np.sqrt(np.maximum(variance, 0.0))


def rules_of(model: FilterModel) -> Rules:
    """Return what holds for a whole run of a model."""
    settings = model.settings
    return Rules(settings.every, settings.gate, settings.patience, np.array(model.installation.lever_arm))


def solve(
    model: FilterModel,
    moves: Measurement,
    found: Corrections,
    start: Alignment,
    without: tuple[float, float] | None = None,
    *,
    smooth: bool = False,
) -> Solution:
    """Run a filter over a log.

    Args:
        model: the filter.
        moves: the IMU.
        found: what corrects it.
        start: where it begins.
        without: s from the log's start; fixes after the one and before the other are not used.
        smooth: whether to keep what ``smoothed`` needs.

    Raises:
        MissingDataError: what the filter carries is no number any more; the message says when.
        ValueError: a process that no filter can carry.
    """
    tables, _ = model.tables(moves.interval, moves.celsius)
    if moves.loose is not None:
        tables.white[-1] += moves.loose
    n = int(tables.first[6])
    state = navigation_state(start.position, start.velocity, start.euler)
    covariance = np.zeros((n, n))
    covariance[:NAVIGATION, :NAVIGATION] = start.covariance
    axes, covariance[NAVIGATION:, NAVIGATION:] = _axes_at_start(model, moves, tables, start)
    rows = flat(covariance)
    count = found.events.at.size
    track = empty_track(count, n, smooth=smooth)
    track.state[start.event], track.axes[start.event], track.covariance[start.event] = state, axes, covariance
    skip = (-1, -1)
    if without is not None:
        skip = int(np.searchsorted(moves.time, without[0])), int(np.searchsorted(moves.time, without[1]))
    rules, space = rules_of(model), workspace(n, transition=smooth)
    if smooth:
        space.transition[:] = flat(np.eye(n))
    ended, event = kernel.run(
        state,
        axes,
        rows,
        moves.samples,
        found.events,
        rules,
        tables,
        space,
        start.sample,
        start.event + 1,
        *skip,
        no_marks(),
        track,
    )
    if ended != kernel.FINE:
        message = (
            f"{model.name}: at {found.time[event]:.1f} s {ENDED[ended]}; the model or its sigmas do not fit this log "
            "(imuwb model check tells what is odd in an error model)"
        )
        raise MissingDataError(message)
    events = np.flatnonzero((found.fix >= 0) & (np.arange(count) >= start.event))
    if without is not None:
        at = found.events.at[events]
        events = events[(at <= skip[0]) | (at >= skip[1])]
    return Solution(model, moves, found, start, tables, rules, track, events)


def no_marks() -> Marks:
    """Return no marks: a run goes on behind its last event."""
    return Marks(np.zeros(0, np.int64), True, np.zeros((0, 10)), np.zeros((0, NAVIGATION, NAVIGATION)))


def empty_track(count: int, n: int, *, smooth: bool = False) -> Track:
    """Return room for a run of so many events and error states; and for what a smoother needs."""
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
    model: FilterModel, moves: Measurement, tables: AxisTables, start: Alignment
) -> tuple[Floats, Floats]:
    """Return the axes' states at the start, and their covariance: a gyro's mean while it stood is a measurement of its error."""
    first = tables.first - NAVIGATION
    states, covariance = np.zeros(first[6]), np.zeros((first[6], first[6]))
    begin, end = start.standing or (start.sample, start.sample)
    celsius = moves.celsius[int(moves.samples.regime[start.sample])]
    for axis, one in enumerate(model.shapings(moves.interval, celsius)):
        place = slice(int(first[axis]), int(first[axis]) + one.order)
        if axis >= 3:  # noqa: PLR2004 - accelerometers: their mean is gravity's, by a tilt that is not known
            covariance[place, place] = axis_start(one, start.sample, 0, 0).covariance
        else:
            known = axis_start(one, begin, end - begin, start.sample - end)
            covariance[place, place] = known.covariance
            if end > begin:
                noise = one.white / ((end - begin) * moves.interval) + EARTH_RATE**2 / 3
                gain = known.cross / (known.variance + noise)
                states[place] = gain * start.gyro_bias[axis]
                covariance[place, place] -= np.outer(gain, known.cross)
        if tables.scale[place.stop : int(first[axis + 1])].any():
            covariance[place.stop, place.stop] = model.scale_factor[axis // 3] ** 2
    return states, covariance

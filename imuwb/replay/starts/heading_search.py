"""The heading at the start of a log that is too slow for a course, by a spread of starts.

Filters that start with headings all around the circle run over the first part of the log. An acceleration in the wrong
direction makes a filter's innovations large, so the innovations show which heading was right. No assumption is made about the
direction in which the vehicle moves: a walker may carry the IMU in any way.

The noise of the sensors and of the receiver is not known at this point. The search therefore runs for several levels of both,
and the most likely level counts. The likelihood of a component is that of Student's t, which outliers do not dominate.
"""

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from imuwb.arrays import Floats
from imuwb.errors import MissingDataError
from imuwb.log import AXES, GnssStream, Log
from imuwb.navigation.alignment import align
from imuwb.navigation.corrections import Corrections, corrections_of, raised
from imuwb.navigation.filter import solve
from imuwb.navigation.filter_model import FilterModel
from imuwb.navigation.measurement import Measurement
from imuwb.navigation.tables import Events
from imuwb.stochastic import AxisModel, Constant, ImuErrorModel, RandomWalk, Sum, WhiteNoise

HORIZON = 120.0  #: s after the start; later innovations hardly depend on the heading at the start
SPACING = 1.0  #: s between two fixes; errors of nearer ones are not independent
WHITE = ((1e-4, 1e-3), (1e-3, 1e-2), (5e-3, 5e-2))  #: levels of rad/s/√Hz and m/s²/√Hz; vehicles vibrate
FLOORS = ((0.05, 0.05), (0.5, 0.2))  #: levels of m and m/s, added to the receiver's sigmas
WALK = (2e-5, 3e-4)  #: rad/s/√s and m/s²/√s
TURN_ON = (
    float(np.radians(1.0)),
    0.3,
)  #: rad/s, m/s², of MEMS that were not calibrated; the model's own if they are larger
GRAVITY = 9.8  #: m/s²
COARSE, FINE = 30.0, 5.0  #: deg between two headings
SPREAD = 0.5  #: sigma of a start's heading, as a share of the step to the next one
DEGREES_OF_FREEDOM = 6.0  #: of Student's t
INDEPENDENT = 0.5  #: share of the innovations that count as independent of the others
UNLIKELY = 12.0  #: a coarse heading whose log-likelihood is this far below the largest one is not refined
VAGUE = 60.0  #: deg; a wider sigma of the coarse headings does not give a heading


@dataclass(frozen=True, eq=False, slots=True)
class FoundHeading:
    """The heading at a start, from a spread of starts."""

    time: float  #: s from the log's start, at which the filters start
    heading: float  #: deg
    sigma: float  #: deg, circular
    starts: int  #: filters that were run
    tried: Floats  #: (k,) deg, the headings at the most likely level of noise
    log_likelihood: Floats  #: (k,) of the innovations, less the largest one

    def __str__(self) -> str:
        """Return the heading and its sigma in a line."""
        return (
            f"Heading {self.heading:.1f} deg, sigma {self.sigma:.2g} deg, at {self.time:.1f} s, of {self.starts} starts"
        )

    __repr__ = __str__


def search_heading(
    log: Log, gnss: GnssStream, measurement: Measurement, stills: Floats, model: FilterModel
) -> FoundHeading | None:
    """Return the heading at the first start that a log allows; None if no heading is more likely than the others.

    Args:
        log: the log; its aids count if the model has them.
        gnss: the receiver.
        measurement: the IMU.
        stills: (s, 2) s from the log's start, the standstills.
        model: installation, settings and aids; its noise is not used.

    Raises:
        MissingDataError: too few fixes.
    """
    runs = _Runs(log, gnss, measurement, stills, model)
    levels = list(product(WHITE, FLOORS))
    headings = np.arange(0.0, 360.0, COARSE)
    coarse = runs.log_likelihoods([(h, COARSE, *level) for level in levels for h in headings])
    coarse = coarse.reshape(len(levels), headings.size)
    if not np.isfinite(coarse).any():
        return None
    best = int(np.unravel_index(np.argmax(coarse), coarse.shape)[0])
    likely = headings[coarse[best] > coarse[best].max() - UNLIKELY]
    if _circular(headings, coarse[best])[1] > VAGUE:
        return None
    offsets = np.arange(-COARSE, COARSE + FINE / 2, FINE)
    tried = np.unique(np.mod(likely[:, None] + offsets, 360.0))
    found = runs.log_likelihoods([(h, FINE, *levels[best]) for h in tried])
    heading, sigma = _circular(tried, found)
    # The spread of each start is part of the uncertainty.
    sigma = float(np.hypot(sigma, SPREAD * FINE))
    return FoundHeading(runs.time, heading, sigma, coarse.size + found.size, tried, found - found.max())


def _circular(headings: Floats, log_likelihood: Floats) -> tuple[float, float]:
    """Return the circular mean and the circular standard deviation of headings, deg, from their log-likelihoods."""
    weights = np.exp(INDEPENDENT * (log_likelihood - log_likelihood.max()))
    mean = (weights * np.exp(1j * np.radians(headings))).sum() / weights.sum()
    spread = float(np.degrees(np.sqrt(-2 * np.log(max(min(abs(mean), 1.0), 1e-300)))))
    return float(np.degrees(np.angle(mean)) % 360), spread


class _Runs:
    """Filters over the first part of a log, each with a heading and levels of noise of its own."""

    def __init__(
        self, log: Log, gnss: GnssStream, measurement: Measurement, stills: Floats, model: FilterModel
    ) -> None:
        """Prepare the events that all filters have in common."""
        begin = model.settings.known_start[0]
        self._turn_on = {axis: _turn_on(model.error_model, axis) for axis in AXES}
        # A bias of an accelerometer tilts the start.
        tilt = max(self._turn_on[axis] for axis in ("accel_x", "accel_y")) / GRAVITY
        settings = replace(
            model.settings, spacing=max(model.settings.spacing, SPACING), known_start=(begin, 0.0, COARSE),
            tilt=float(np.hypot(model.settings.tilt, np.degrees(tilt))),
        )  # fmt: skip
        self._model, self._measurement, self._stills = replace(model, settings=settings), measurement, stills
        events = corrections_of(log, gnss, measurement, stills, self._model)
        start = align(measurement, events, stills, self._model)
        self.time = float(events.time[start.event])
        self._corrections = _until(events, self.time + HORIZON)

    def log_likelihoods(
        self, starts: Sequence[tuple[float, float, tuple[float, float], tuple[float, float]]]
    ) -> Floats:
        """Return the log-likelihood of each start: heading and step to the next one, deg, white noise, and floors."""
        with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
            return np.array(list(pool.map(self._log_likelihood, starts)))

    def _log_likelihood(self, start: tuple[float, float, tuple[float, float], tuple[float, float]]) -> float:
        heading, step, white, floor = start
        settings = self._model.settings
        known = settings.known_start[0], heading, SPREAD * step
        settings = replace(settings, known_start=known, sigma_floor=floor, gnss_correlation=(0.0, 0.0))
        model = replace(self._model, error_model=self._noise(white), settings=settings)
        alignment = align(self._measurement, self._corrections, self._stills, model)
        try:
            track = solve(model, self._measurement, raised(self._corrections, floor), alignment).track
        except MissingDataError:  # a filter that fails is one with the wrong start
            return -np.inf
        after = slice(alignment.event + 1, None)
        known = np.isfinite(track.innovation[after])
        deviation = track.deviation[after][known]
        z = track.innovation[after][known] / deviation
        freedom = DEGREES_OF_FREEDOM
        return float(-((freedom + 1) / 2 * np.log1p(z * z / freedom) + np.log(deviation)).sum())

    def _noise(self, white: tuple[float, float]) -> ImuErrorModel:
        axes: dict[str, AxisModel] = {}
        for axis in AXES:
            k = int(axis.startswith("accel"))
            axes[axis] = AxisModel(Sum((WhiteNoise(white[k]), RandomWalk(WALK[k]), Constant(self._turn_on[axis]))))
        return ImuErrorModel("spread of starts", axes)


def _turn_on(model: ImuErrorModel, axis: str) -> float:
    """Return the sigma of an axis's turn-on bias."""
    terms = model.axes[axis].processes.terms if axis in model.axes else ()
    stated = [term.sigma for term in terms if isinstance(term, Constant)]
    return float(max(TURN_ON[int(axis.startswith("accel"))], *stated, 0.0))


def _until(corrections: Corrections, end: float) -> Corrections:
    kept, own = corrections.time <= end, corrections.events
    events = Events(own.at[kept], own.kind[kept], own.late[kept], own.value[kept], own.variance[kept])
    return replace(corrections, events=events, time=corrections.time[kept], fix=corrections.fix[kept])

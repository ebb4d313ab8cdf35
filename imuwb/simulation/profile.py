"""A driver's legs as smooth functions of time, and the road as smooth functions of the distance.

All are quintic B-splines over even knots. They have four continuous derivatives. Their values stay within the bounds of the
control points, and their slopes within those of the control polygon. Knots half a second apart leave no motion at 5 Hz.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BSpline

from imuwb.arrays import Floats
from imuwb.simulation.legs import SLOWING_DOWN, SPEEDING_UP, Leg, Pin

DEGREE = 5
MARGIN = 3  #: control points outside each end that a value at the end depends on
STEP = 0.5  #: s between control points
UNEVEN = 0.03  #: share by which a driver misses the wanted speed
UNEVEN_STEP = 4.0  #: s, after which the driver corrects the speed
TAPER = 8.0  #: s, from a pinned speed to the wanted one

ROAD_STEP = 100.0  #: m between the road's control points
STEEPEST = 0.05  #: rad
SLOPE, BANK, BEND = 0.02, 0.02, 0.008  #: rad, sigma of a control point


@dataclass(frozen=True, slots=True)
class Profile:
    """Speed, heading and road of a route."""

    manoeuvres: BSpline  #: s -> speed m/s, heading of the manoeuvres rad
    road: BSpline  #: m driven -> slope up, bank to the right, bend off the manoeuvres' heading; rad


def profile(legs: Sequence[Leg], pins: Sequence[Pin], rng: np.random.Generator) -> Profile:
    """Return legs made smooth; the mean speeds of ``pins`` are met exactly.

    Args:
        legs: from time 0 on, the first standing.
        pins: intervals and the mean speed in each.
        rng: for the driver's unevenness and the road.
    """
    ends = np.cumsum([leg.duration for leg in legs])
    time = np.arange(-MARGIN, np.ceil(ends[-1] / STEP) + MARGIN + 1) * STEP
    speeds = np.array([leg.speed for leg in legs])[np.searchsorted(ends[:-1], time, side="right")]
    speed = _uneven(_reachable(speeds, time), time, rng)
    turned = np.cumsum([rng.uniform(-np.pi, np.pi), *(leg.turn for leg in legs)])
    heading = np.interp(time, [0.0, *ends], turned)
    manoeuvres = np.stack([_pinned(speed, time, pins), heading], axis=1)
    length = manoeuvres[:, 0].sum() * STEP
    count = int(length / ROAD_STEP) + 2 * MARGIN + 2
    road = rng.standard_normal((count, 3)) * (SLOPE, BANK, BEND)
    return Profile(_smooth(manoeuvres, STEP), _smooth(road.clip(-STEEPEST, STEEPEST), ROAD_STEP))


def _smooth(controls: Floats, step: float) -> BSpline:
    """Return the spline whose control point k, counted from -MARGIN, has its largest weight at k step."""
    knots = (np.arange(controls.shape[0] + DEGREE + 1) - MARGIN - (DEGREE + 1) / 2) * step
    return BSpline(knots, controls, DEGREE)


def _reachable(speed: Floats, time: Floats) -> Floats:
    """Return the highest speeds, at most the wanted ones, that the limits of braking and speeding up allow."""
    reached = np.minimum.accumulate(speed - SPEEDING_UP * time) + SPEEDING_UP * time
    braked = np.minimum.accumulate((reached + SLOWING_DOWN * time)[::-1])[::-1]
    return braked - SLOWING_DOWN * time


def _uneven(speed: Floats, time: Floats, rng: np.random.Generator) -> Floats:
    knots = np.arange(time[0], time[-1] + UNEVEN_STEP, UNEVEN_STEP)
    return speed * (1 + np.interp(time, knots, rng.uniform(-UNEVEN, UNEVEN, knots.size)))


def _pinned(speed: Floats, time: Floats, pins: Sequence[Pin]) -> Floats:
    """Return control points scaled around each pin so that the mean speed is the pinned one; it is linear in the points."""
    if not pins:
        return speed
    shapes = [
        np.interp(time, [p.start - TAPER, p.start, p.start + p.duration, p.start + p.duration + TAPER], [0, 1, 1, 0])
        for p in pins
    ]
    driven = _smooth(np.stack([speed, *(speed * shape for shape in shapes)], axis=1), STEP).antiderivative()
    means = np.array([(driven(p.start + p.duration) - driven(p.start)) / p.duration for p in pins])
    scale = np.linalg.solve(means[:, 1:], [p.speed for p in pins] - means[:, 0])
    return speed * (1 + scale @ np.array(shapes))

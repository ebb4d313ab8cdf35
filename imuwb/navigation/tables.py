"""The inputs and outputs of the filter's compiled loops: tuples of arrays."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from imuwb.arrays import Booleans, Floats, Integers

FIX, SPEED, STRAIGHT, STILL = 0, 1, 2, 3  #: kinds of event: GNSS fix, forward speed, no slip, standstill
MOST_ROWS = 6  #: largest number of measurements of an event


class AxisTables(NamedTuple):
    """The shaping filters of all six axes, in the form that the kernels need.

    There are R regimes of temperature, of which one applies at a time, and K states, at most O for each axis. The index of
    M + 1 values is the number of samples in a span, 0 to M.
    """

    first: Integers  #: (7,) index of each axis's first state among all error states; the last value is the number of states
    step: Floats  #: (R, K) contribution of a state to its axis's error at an instant; 1 for a scale factor
    scale: NDArray[
        np.bool_
    ]  #: (K,) whether a state is a scale factor, whose contribution is multiplied by the measurement
    output: Floats  #: (R, M + 1, K) contribution of a state at the start of a span to the mean error over the span
    transition: Floats  #: (R, M + 1, 6, O, O) over the span
    noise: Floats  #: (R, M + 1, 6, O, O) covariance of the states' noise over the span
    inside: Floats  #: (R, M + 1, 6) variance that this noise adds to the sum of the span's errors
    cross: Floats  #: (R, M + 1, K) covariance of the states' noise and that sum
    white: Floats  #: (R, 6) density of white noise, unit²/Hz, two-sided
    receiver: Integers  #: (3,) index among all error states of the receiver's position errors, NED; 0: there are no such states


class Samples(NamedTuple):
    """The inertial measurement: n steps."""

    interval: Floats  #: (n,) s
    angle: Floats  #: (n, 3) rad, integral of the measured angular rate
    velocity: Floats  #: (n, 3) m/s, integral of the measured specific force
    regime: Integers  #: (n,) regime of the model's tables


class Events(NamedTuple):
    """The E events that correct the filter, in order of time."""

    at: Integers  #: (E,) the sample after which the event counts
    kind: Integers  #: (E,) FIX, SPEED, STRAIGHT or STILL
    late: Floats  #: (E,) s from the end of that sample to the measurement; at most half an interval
    value: Floats  #: (E, 6) of a fix: position rad, rad, m and velocity m/s NED; of a speed: m/s forward
    variance: Floats  #: (E, 6) m², (m/s)²; 0: not measured


class Rules(NamedTuple):
    """The rules of a whole run."""

    every: int  #: samples between two propagations of the covariance
    gate: float  #: normalised innovation squared of a position or a velocity, above which it is refused
    patience: int  #: fixes refused in a row before the filter accepts the next one
    lever: Floats  #: (3,) m FRD, from the IMU to the antenna
    point: Floats  #: (3,) m FRD, from the IMU to the point of the vehicle that does not slip


class Marks(NamedTuple):
    """The L marks at which a run reports its state between events."""

    at: Integers  #: (L,) number of samples up to the mark, rising
    with_covariance: bool  #: whether the covariance is propagated
    state: Floats  #: (L, 10) output: position, velocity, quaternion
    covariance: Floats  #: (L, 9, 9) output: of position, velocity and attitude


class Prior(NamedTuple):
    """The state of a run before each of its events."""

    state: Floats  #: (E, SIZE)
    axes: Floats  #: (E, K)
    covariance: Floats  #: (E, n, n)
    transition: Floats  #: (E, n, n) since the event before


class Track(NamedTuple):
    """The state of a run after each of its events."""

    state: Floats  #: (E, SIZE)
    axes: Floats  #: (E, K)
    covariance: Floats  #: (E, n, n)
    innovation: Floats  #: (E, 6) m and m/s, measured minus predicted; nan: not measured
    deviation: Floats  #: (E, 6) sigma of the innovation
    nis: Floats  #: (E, 2) normalised innovation squared of position and of velocity; nan: not measured
    used: Booleans  #: (E, 2) whether position and velocity passed the gate
    before: Prior  #: the states before the events, for a smoother; empty: not kept

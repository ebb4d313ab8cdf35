"""What the filter's compiled loops take and leave: tuples of arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Integers = NDArray[np.int64]

FIX, SPEED, STRAIGHT, STILL = 0, 1, 2, 3  #: kinds of event: a GNSS fix, a forward speed, no slip, standing still
MOST_ROWS = 6  #: measurements of an event


class AxisTables(NamedTuple):
    """The shaping filters of all six axes, as the kernels take them.

    One of R regimes (of temperature) holds at a time; a model that knows no temperature has one. K states in all, of at most O
    an axis; tables by the number of samples in a span, 0 to M.
    """

    first: Integers  #: (7,) where an axis's states begin among all error states; the last: their number
    step: Floats  #: (R, K) what a state adds to its axis's error at an instant; of a scale factor, 1
    scale: NDArray[np.bool_]  #: (K,) whether a state is a scale factor: what it adds is times the measurement
    output: Floats  #: (R, M + 1, K) what a state at the beginning of a span adds to the mean error over it
    transition: Floats  #: (R, M + 1, 6, O, O) over the span
    noise: Floats  #: (R, M + 1, 6, O, O) covariance of what comes into the states
    inside: Floats  #: (R, M + 1, 6) variance of the sum of the span's samples that comes in within it
    cross: Floats  #: (R, M + 1, K) covariance of both
    white: Floats  #: (R, 6) density of white noise, unit²/Hz, two-sided


class Samples(NamedTuple):
    """The inertial measurement: n steps."""

    interval: Floats  #: (n,) s
    angle: Floats  #: (n, 3) rad, integral of the measured angular rate
    velocity: Floats  #: (n, 3) m/s, of the measured specific force
    regime: NDArray[np.int64]  #: (n,) which of the model's tables holds


class Events(NamedTuple):
    """What corrects the filter, in order of time: E events."""

    at: Integers  #: (E,) the sample behind which it counts
    kind: Integers  #: (E,) FIX, SPEED, STRAIGHT or STILL
    late: Floats  #: (E,) s by which the measurement is behind the end of that sample; within half an interval
    value: Floats  #: (E, 6) of a fix position rad, rad, m and velocity m/s NED; of a speed m/s forward
    variance: Floats  #: (E, 6) m², (m/s)²; 0 where there is no such measurement


class Rules(NamedTuple):
    """What holds for a whole run."""

    every: int  #: samples between two covariances
    gate: float  #: a position's or a velocity's normalised innovation squared above which it is not used
    patience: int  #: fixes refused one behind the other before the filter believes them
    lever: Floats  #: (3,) m FRD, from the IMU to the antenna


class Marks(NamedTuple):
    """Where a run is looked at between its events; L of them."""

    at: Integers  #: (L,) samples behind which, rising
    with_covariance: bool  #: whether covariances are carried
    state: Floats  #: (L, 10) written: position, velocity, quaternion
    covariance: Floats  #: (L, 9, 9) written: of position, velocity and attitude


class Prior(NamedTuple):
    """What a run leaves of each of its events before it is taken in."""

    state: Floats  #: (E, SIZE)
    axes: Floats  #: (E, K)
    covariance: Floats  #: (E, n, n)
    transition: Floats  #: (E, n, n) from behind the event before


class Track(NamedTuple):
    """What a run leaves of each of its events."""

    state: Floats  #: (E, SIZE) behind the event
    axes: Floats  #: (E, K)
    covariance: Floats  #: (E, n, n) behind the event
    innovation: Floats  #: (E, 6) m and m/s, measured less predicted; nan: none
    deviation: Floats  #: (E, 6) its sigma
    nis: Floats  #: (E, 2) of position and of velocity; nan: none
    used: NDArray[np.bool_]  #: (E, 2)
    before: Prior  #: what a smoother needs besides; empty: it is not wanted

"""Which periodic lines of an error model a filter carries: those that matter in outages, up to the room there is.

A line is A sin(w t + phi) with a phase phi that is unknown, and w = 2 pi f. An outage begins with a known velocity and attitude.
With x = w T, two integrals of an accelerometer's line give, after T, the position error

    A/w² ((x - sin x) cos phi + (1 - cos x) sin phi)

A gyro's line tilts the navigation frame, and the tilt turns gravity g into an acceleration; three integrals give

    g A/w³ ((x²/2 - 1 + cos x) cos phi + (x - sin x) sin phi)

The mean of the square over phi is half the sum of the squares of both factors. For f = 0 these are the errors A T²/2 and
g A T³/6 of a constant bias (Groves, 5.7). White noise of density N² gives N² T³/3 and g² N² T⁵/20 in the same way. A gyro whose
axis is vertical tilts nothing; the formula is then an upper limit.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats
from imuwb.log import AXES
from imuwb.stochastic import Sinusoid, Sum, WhiteNoise
from imuwb.units import STANDARD_GRAVITY

LEAST = 0.01  #: share of the variance of the drift that the lines without states may have together
TIMES = 8  #: lengths of an outage, between the shortest and the longest, at which the shares are computed


@dataclass(frozen=True, slots=True)
class LineShare:
    """A line of an error model, and what it adds to the drift."""

    axis: str
    term: int  #: its place among the processes of the axis
    frequency: float  #: Hz
    share: float  #: largest share of the variance of the drift by lines and white noise, among the lengths of outages

    def __str__(self) -> str:
        """Return axis and frequency."""
        return f"{self.axis} at {self.frequency:.4g} Hz"


def line_drift(amplitude: float, frequency: float, time: Floats, *, gyro: bool) -> Floats:
    """Return the mean square of the position error that a line makes in an outage, m² (formulas at the head of this module).

    Args:
        amplitude: rad/s or m/s².
        frequency: Hz.
        time: s, length of the outage.
        gyro: whether the line is that of a gyro; else of an accelerometer.
    """
    w = 2 * np.pi * frequency
    x = w * time
    once, level = x - np.sin(x), 2 * np.sin(x / 2) ** 2
    if not gyro:
        return amplitude**2 / (2 * w**4) * (once**2 + level**2)
    return (STANDARD_GRAVITY * amplitude) ** 2 / (2 * w**6) * ((x**2 / 2 - level) ** 2 + once**2)


def white_drift(N: float, time: Floats, *, gyro: bool) -> Floats:
    """Return the mean square of the position error that white noise makes in an outage, m².

    Args:
        N: rad/s/√Hz or m/s²/√Hz.
        time: s, length of the outage.
        gyro: whether the noise is that of a gyro; else of an accelerometer.
    """
    return (STANDARD_GRAVITY * N) ** 2 * time**5 / 20 if gyro else N**2 * time**3 / 3


def left_out(axes: Sequence[Sum], room: int, horizons: tuple[float, float]) -> tuple[LineShare, ...]:
    """Return the lines that get no states: those that add little to the drift, and those for which there is no room.

    The weakest lines are left out as long as their shares stay below 1 % together.

    Args:
        axes: the processes of ``gyro_x`` ... ``accel_z``.
        room: number of lines for which there is room.
        horizons: s, shortest and longest outage.
    """
    time = np.geomspace(horizons[0], horizons[1], TIMES)
    whole = np.zeros(TIMES)
    lines: list[tuple[str, int, float, Floats]] = []
    for axis, processes in zip(AXES, axes, strict=True):
        gyro = axis.startswith("gyro")
        for place, term in enumerate(processes.terms):
            if isinstance(term, WhiteNoise):
                whole += white_drift(term.N, time, gyro=gyro)
            elif isinstance(term, Sinusoid):
                lines.append((axis, place, term.frequency, line_drift(term.amplitude, term.frequency, time, gyro=gyro)))
                whole += lines[-1][-1]
    shares = [(axis, place, f, own / np.where(whole > 0, whole, 1.0)) for axis, place, f, own in lines]
    shares.sort(key=lambda line: float(line[-1].max()))
    total = np.zeros(TIMES)
    chosen: list[LineShare] = []
    for k, (axis, place, frequency, share) in enumerate(shares):
        total = total + share
        if total.max() > LEAST and len(shares) - k <= room:
            break
        chosen.append(LineShare(axis, place, frequency, float(share.max())))
    return tuple(chosen)

"""The flat part of an Allan curve, from which the papers read the correlation time of bias instability (Quinchia, 5.5 and table 5)."""

from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats
from imuwb.statistics import Estimate

FLAT = 1.05  #: the flat part of a smooth curve is below this multiple of its smallest value
NEAR = 1.1  #: and the measured curve is within this factor of that value
OCTAVE = 2.0  #: least ratio of end to begin, where the measured curve decides
CLUSTERS = 9  #: averaging times with fewer clusters in the record scatter too much to be read
STEPS = 400  #: of the grid on which the part is found


@dataclass(frozen=True, slots=True)
class FlatPart:
    """Averaging times, s, between which an Allan deviation is flat."""

    begin: float
    end: float
    ends: bool  #: the curve goes on beyond the end; if not, the part may be longer

    @property
    def centre(self) -> float:
        """Return the arithmetic middle, as the paper reads it: between 321.92 and 654.01 s it is 488 s, and table 5 has 490.89 s."""
        return (self.begin + self.end) / 2

    @property
    def correlation_time(self) -> Estimate:
        """Return the middle, between begin and end; it is a lower bound, without an upper end, if the part may be longer."""
        return Estimate(self.centre, self.begin, self.end if self.ends else float("inf"), unit="s")


def flat_part(tau: Floats, deviation: Floats, share: float = FLAT) -> FlatPart:
    """Return the averaging times around the smallest Allan deviation, as far as it stays below a multiple of this.

    Args:
        tau: (k,) s, rising.
        deviation: (k,) of a smooth curve.
        share: the multiple.
    """
    least = int(np.argmin(deviation))
    high = np.flatnonzero(deviation > share * deviation[least])
    first, last = int(high[high < least].max(initial=-1)) + 1, int(high[high > least].min(initial=tau.size)) - 1
    return FlatPart(float(tau[first]), float(tau[last]), last < tau.size - 1)


def measured_flat_part(tau: Floats, deviation: Floats, smooth: Floats, duration: float) -> FlatPart:
    """Return the flat part of a measured curve: it begins where that of the fitted curve does, and ends where either leaves it.

    The fitted curve of a sum without K or R stays flat for ever. As on paper, the flat part then ends where the measured curve
    goes away from the fitted level; with averaging times of few clusters, that is by chance.

    Args:
        tau: (k,) s, averaging times.
        deviation: (k,) measured.
        smooth: (k,) fitted.
        duration: s, of the record.
    """
    used = tau <= max(duration / CLUSTERS, float(tau[1]))
    x = np.log(tau[used])
    grid = np.linspace(x[0], x[-1], STEPS)
    measured, fitted = (np.interp(grid, x, np.log(part[used])) for part in (deviation, smooth))
    own = flat_part(np.exp(grid), np.exp(fitted))
    away = np.flatnonzero((np.exp(grid) > OCTAVE * own.begin) & (np.abs(measured - fitted.min()) > np.log(NEAR)))
    if away.size == 0 or (end := float(np.exp(grid[away[0]]))) >= own.end:
        return own
    return FlatPart(own.begin, end, ends=True)

"""What the gate of a filter refuses, and whether the positions contradict themselves or the filter is too sure."""

from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.geodesy.earth import ned_scale
from imuwb.navigation.corrections import Corrections
from imuwb.navigation.filter import Solution
from imuwb.navigation.tables import FIX
from imuwb.notes import Note

MANY, FEW = 0.05, 5  #: share and number of refused positions from which a note says why
LONGEST = 2.6  #: s between two positions that are compared
PAIRS = 20  #: fewest pairs
TURNS = 0.1  #: m/s³ / 12 times the third power of a second: what the mean of two velocities misses
CLAIMED_TOO_SMALL = 3.0  #: ratio of the scatter to what the sigmas explain
RAYLEIGH = 1.18  #: median of the length of a vector over the sigma of its two components


@dataclass(frozen=True, slots=True)
class Refusals:
    """The positions that a filter's gate refuses."""

    count: int
    of: int  #: positions after the alignment
    offset: float  #: m, median horizontal innovation of the refused ones
    claimed: float  #: m, median horizontal sigma of the refused ones, as the filter takes it
    scatter: float  #: m, sigma of the positions against their own velocities; nan: there are too few velocities
    explained: float  #: m, what the sigmas of positions and velocities explain of it

    @property
    def contradictory(self) -> bool:
        """Whether the positions scatter by more than they claim."""
        return self.scatter > CLAIMED_TOO_SMALL * self.explained


def refusals(solution: Solution) -> Refusals | None:
    """Return what the gate refuses; None if it refuses few positions."""
    corrections, track = solution.corrections, solution.track
    rows = np.flatnonzero((corrections.events.kind == FIX) & np.isfinite(track.nis[:, 0]))
    # A position that is accepted by force after many that are refused does not pass the gate either.
    refused = rows[~track.used[rows, 0] | (track.nis[rows, 0] > solution.rules.gate)]
    if refused.size < max(FEW, MANY * rows.size):
        return None
    off = track.innovation[refused, :2]
    sigma = np.sqrt(corrections.events.variance[refused, :2].max(axis=1))
    scatter, explained = _scatter(corrections, rows)
    return Refusals(
        refused.size,
        rows.size,
        float(np.nanmedian(np.hypot(off[:, 0], off[:, 1]))),
        float(np.median(sigma)),
        scatter,
        explained,
    )


def _scatter(corrections: Corrections, rows: Integers) -> tuple[float, float]:
    """Return the sigma of positions against the integral of their own velocities, m, and what their sigmas explain."""
    events = corrections.events
    whole = rows[(events.variance[rows, :2] > 0).all(axis=1) & (events.variance[rows, 3:5] > 0).all(axis=1)]
    span = np.diff(corrections.time[whole])
    near = (span > 0) & (span < LONGEST)
    if np.count_nonzero(near) < PAIRS:
        return np.nan, np.nan
    first, second, span = whole[:-1][near], whole[1:][near], span[near]
    scale = ned_scale(events.value[first, 0], events.value[first, 2])[:, :2]
    moved = (events.value[second, :2] - events.value[first, :2]) * scale
    mean = (events.value[first, 3:5] + events.value[second, 3:5]) / 2
    off: Floats = moved - mean * span[:, None]
    variance = events.variance[first] + events.variance[second]
    expected = np.sqrt(
        variance[:, :2].max(axis=1) + variance[:, 3:5].max(axis=1) * (span / 2) ** 2 + (TURNS * span**3) ** 2
    )
    root = np.sqrt(2)
    return float(np.median(np.hypot(off[:, 0], off[:, 1])) / RAYLEIGH / root), float(np.median(expected) / root)


def refusal_note(solution: Solution) -> Note | None:
    """Return a note on what the gate refuses, why, and what helps; None if it refuses few positions."""
    found = refusals(solution)
    if found is None:
        return None
    sure = "the filter is too sure of itself: its noise is too small, or the delay, the mounting or the start is wrong"
    if np.isnan(found.scatter):
        sure += "; or the positions are worse than they claim: --gnss-floor M,0 widens their sigmas"
    why = (
        f"the positions scatter by {found.scatter:.2g} m against their own velocities, where their sigmas explain "
        f"{found.explained:.1g} m: state --gnss-floor {found.scatter:.1g},0"
        if found.contradictory
        else sure
    )
    text = (
        f"{solution.model.name} refuses {found.count} of {found.of} positions, which are {found.offset:.2g} m off in the median with a "
        f"sigma of {found.claimed:.2g} m; {why}"
    )
    return Note("refused-positions", text)

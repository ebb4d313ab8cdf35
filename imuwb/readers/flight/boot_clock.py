"""A clock that counts from power-up, and starts anew at each reboot, mapped to the recorder's or to Unix time."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Nanoseconds = NDArray[np.int64]

BACK = 5_000_000_000  #: ns; a clock that steps back by more was started anew, by less a message is late
EARLIEST = 946_684_800 * 10**9  #: ns of 2000-01-01: no flight controller tells an earlier date that it knows


@dataclass(frozen=True, eq=False, slots=True)
class BootClock:
    """Runs of a clock between reboots, each with what is added to it."""

    start: NDArray[np.int64]  #: (k,) place in the file where a run begins
    offset: Nanoseconds  #: (k,) ns
    ahead: int  #: ns, of Unix time over the recorder's; 0 where the log does not know it
    known: bool  #: the log itself says what Unix time it is

    def with_recorder(self, ahead: int) -> BootClock:
        """Return the clock as it runs when Unix time is ``ahead`` ns ahead of the recorder's: another clock of the file told."""
        return self if self.known else BootClock(self.start, self.offset + ahead, ahead, known=True)

    @property
    def reboots(self) -> int:
        """Return how often the clock started anew."""
        return self.start.size - 1

    def unix(self, place: NDArray[np.int64], boot: Nanoseconds) -> Nanoseconds:
        """Return boot times of messages at places in the file as Unix time, ns."""
        return boot + self.offset[np.searchsorted(self.start, place, side="right").clip(1) - 1]


def boot_clock(place: NDArray[np.int64], boot: Nanoseconds, recorded: Nanoseconds, unix: Nanoseconds) -> BootClock:
    """Return how a boot clock runs against the recorder's, and against Unix time where messages tell it.

    Args:
        place: (n,) of messages in the file, rising.
        boot: (n,) ns since power-up.
        recorded: (n,) ns, the recorder's time.
        unix: (n,) ns since 1970 as the message tells; before 2000 (0, say) where it does not know.
    """
    if not place.size:
        none = np.zeros(1, np.int64)
        return BootClock(none, none, 0, known=False)
    begins = np.concatenate([[0], np.flatnonzero(np.diff(boot) < -BACK) + 1, [place.size]])
    sure = unix > EARLIEST
    ahead = int(np.median((unix - recorded)[sure])) if sure.any() else 0
    offsets: list[int] = []
    for a, b in pairwise(begins):
        inside = slice(int(a), int(b))
        told = unix[inside][sure[inside]] - boot[inside][sure[inside]]
        # What arrives late is recorded late; the median is that of the usual way.
        usual = told if told.size else recorded[inside] - boot[inside] + ahead
        offsets.append(int(np.median(usual)))
    start = place[begins[:-1]].copy()
    start[0] = 0
    return BootClock(start, np.array(offsets), ahead, known=bool(sure.any()))

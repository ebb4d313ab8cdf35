"""A clock that counts from power-up and restarts at each reboot, converted to the recorder's or to Unix time."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from imuwb.arrays import Integers
from imuwb.log import Nanoseconds

BACK = 5_000_000_000  #: ns; a larger step back is a reboot, a smaller one a late message
EARLIEST = 946_684_800 * 10**9  #: ns of 2000-01-01; a flight controller that states an earlier date does not know it


@dataclass(frozen=True, eq=False, slots=True)
class BootClock:
    """The runs of a clock between reboots, and the offset of each."""

    start: Integers  #: (k,) position in the file where each run begins
    offset: Nanoseconds  #: (k,) ns, to be added to the boot time
    ahead: int  #: ns by which Unix time is ahead of the recorder's; 0 if unknown
    known: bool  #: whether the log states the Unix time

    def with_recorder(self, ahead: int) -> BootClock:
        """Return the clock, corrected if another clock of the file states that Unix time is ``ahead`` ns ahead of the recorder's."""
        return self if self.known else BootClock(self.start, self.offset + ahead, ahead, known=True)

    @property
    def reboots(self) -> int:
        """Number of restarts of the clock."""
        return self.start.size - 1

    def unix(self, place: Integers, boot: Nanoseconds) -> Nanoseconds:
        """Return boot times of messages as Unix times (ns).

        Args:
            place: (n,) positions of the messages in the file.
            boot: (n,) ns since power-up.
        """
        return boot + self.offset[np.searchsorted(self.start, place, side="right").clip(1) - 1]


def boot_clock(place: Integers, boot: Nanoseconds, recorded: Nanoseconds, unix: Nanoseconds) -> BootClock:
    """Return a boot clock's offsets to the recorder's clock, and to Unix time if messages state it.

    Args:
        place: (n,) positions of messages in the file, rising.
        boot: (n,) ns since power-up.
        recorded: (n,) ns, the recorder's time.
        unix: (n,) ns since 1970 as the message states; a time before 2000 is unknown.
    """
    if not place.size:
        zero = np.zeros(1, np.int64)
        return BootClock(zero, zero, 0, known=False)
    runs = np.concatenate([[0], np.flatnonzero(np.diff(boot) < -BACK) + 1, [place.size]])
    stated = unix > EARLIEST
    ahead = int(np.median((unix - recorded)[stated])) if stated.any() else 0
    offsets: list[int] = []
    for a, b in pairwise(runs):
        run = slice(int(a), int(b))
        differences = (unix[run] - boot[run])[stated[run]]
        # A delayed message is recorded late; the median has the usual delay.
        offsets.append(int(np.median(differences if differences.size else recorded[run] - boot[run] + ahead)))
    start = place[runs[:-1]].copy()
    start[0] = 0
    return BootClock(start, np.array(offsets), ahead, known=bool(stated.any()))

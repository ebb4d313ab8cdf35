"""The timelines of a recording: that of the log, and one for each part of it that is looked at alone."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import rerun as rr

from imuwb.arrays import Booleans, Integers
from imuwb.log import SECOND
from imuwb.review.scene.clock import Clock

ROWS = 65_536  #: rows of a chunk
#: returns the columns of some rows, (k,) indices
Columns: TypeAlias = Callable[[Integers], Any]


@dataclass(frozen=True, slots=True)
class Window:
    """A part of the log on a timeline of its own, whose zero lies within it."""

    name: str
    begin: int  #: ns
    zero: int  #: ns
    end: int  #: ns

    def holds(self, time: Integers) -> Booleans:
        """Return which times lie within, (n,)."""
        return np.asarray((time >= self.begin) & (time <= self.end))


@dataclass(frozen=True, eq=False, slots=True)
class _Rows:
    path: str
    time: Integers
    columns: Columns
    on: tuple[str, ...] | None  #: the windows that show them; "" is the log's own timeline; None: all


class Timelines:
    """Keeps rows until all windows are known, and then sends each row once, with its time on every timeline.

    A view shows one timeline at a time. A row without a time on it would be missing there, so each row within a window gets its
    time in the window too.
    """

    def __init__(self, clock: Clock) -> None:
        """Begin without rows and windows, on the clock of the recording."""
        self.clock = clock
        self.windows: list[Window] = []
        self._rows: list[_Rows] = []

    def window(self, window: Window) -> None:
        """Add a window."""
        self.windows.append(window)

    def rows(self, path: str, time: Integers, columns: Columns, on: tuple[str, ...] | None = None) -> None:
        """Keep the rows of an entity.

        Args:
            path: of the entity.
            time: (n,) ns.
            columns: makes the columns of some rows.
            on: names of the windows that show the rows; "" is the timeline of the whole log. None: all that they lie in.
        """
        if time.size:
            self._rows.append(_Rows(path, time, columns, on))

    @property
    def first(self) -> str:
        """Return the timeline that is shown first: that of the first window, or of the whole log."""
        return self.windows[0].name if self.windows else self.clock.timeline

    def send(self, recording: rr.RecordingStream) -> None:
        """Send all rows."""
        for kept in self._rows:
            for chosen, indices in self._parts(kept):
                for start in range(0, indices.size, ROWS):
                    own = indices[start : start + ROWS]
                    time = kept.time[own]
                    index = [self._column(window, time) for window in chosen]
                    recording.send_columns(kept.path, index, kept.columns(own))
        self._rows.clear()

    def _parts(self, kept: _Rows) -> Iterator[tuple[Sequence[Window | None], Integers]]:
        """Yield the timelines of rows, of which None is that of the log, and the indices of the rows that have just these."""
        on = kept.on
        windows: list[Window | None] = [window for window in self.windows if on is None or window.name in on]
        inside = [window.holds(kept.time) for window in windows if window is not None]
        if on is None or "" in on:
            windows.append(None)
            inside.append(np.ones(kept.time.size, dtype=bool))
        if not windows:
            return
        code = np.zeros(kept.time.size, dtype=np.int64)
        for bit, holds in enumerate(inside):
            code += holds.astype(np.int64) << bit
        for value in np.unique(code).tolist():
            chosen = [window for bit, window in enumerate(windows) if value >> bit & 1]
            if chosen:
                yield chosen, np.flatnonzero(code == value)

    def _column(self, window: Window | None, time: Integers) -> rr.TimeColumn:
        if window is not None:
            return rr.TimeColumn(window.name, duration=(time - window.zero).astype("timedelta64[ns]"))
        if self.clock.epoch == "unix":
            return rr.TimeColumn(self.clock.timeline, timestamp=time.astype("datetime64[ns]"))
        return rr.TimeColumn(self.clock.timeline, duration=time.astype("timedelta64[ns]"))


def seconds(time: float) -> int:
    """Return a duration in ns."""
    return round(time * SECOND)

"""The clock of a recording: that of its first log. A viewer shows one clock at a time, and a series on another would be blank."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from imuwb.analysis import Series
from imuwb.log import Epoch, Log

TIMELINES: dict[Epoch, str] = {"unix": "time", "boot": "time_since_start", "log": "time_since_start"}
BEGINS: dict[Epoch, str] = {"unix": "1970", "boot": "the power-up", "log": "the log's start"}


@dataclass(frozen=True, slots=True)
class Clock:
    """Where the time of a recording begins."""

    epoch: Epoch = "log"
    zero: int = 0  #: ns; start of the first log on this clock

    @staticmethod
    def of(logs: Sequence[Log]) -> Clock:
        """Return the clock of the first log."""
        return Clock(epoch_of(logs[0]), logs[0].zero or 0) if logs else Clock()

    @property
    def timeline(self) -> str:
        """Name of the timeline in the recording."""
        return TIMELINES[self.epoch]

    def on(self, series: Series) -> Series:
        """Return a series with the epoch of this clock.

        Raises:
            ValueError: the series has another clock.
        """
        if series.epoch is not None and TIMELINES[series.epoch] != self.timeline:
            raise ValueError(
                f"the series {series.title!r} counts its time from {BEGINS[series.epoch]}, the recording from {BEGINS[self.epoch]}, "
                "so no chart would show it; give the times of the log, and leave Series.epoch out"
            )
        return replace(series, epoch=self.epoch)

    def moved(self, series: Series, log: Log) -> Series:
        """Return a series of a log; that of a log with another clock starts when this clock's log starts."""
        if TIMELINES[epoch_of(log)] == self.timeline:
            return replace(series, epoch=self.epoch)
        return replace(series, time=series.time - (log.zero or 0) + self.zero, epoch=self.epoch)


def epoch_of(log: Log) -> Epoch:
    """Return where the time of a log begins."""
    for stream in (*log.imus, *log.gnss, *log.references):
        return stream.origin.epoch
    return "log"

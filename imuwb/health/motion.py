"""When an IMU is still and when it moves."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from imuwb import identification
from imuwb.health.channel import Channel
from imuwb.health.lone import Lone


@dataclass(frozen=True, slots=True)
class Segment:
    """A recorded span during which the IMU is still, or moves."""

    start: float  #: s from the log's start
    end: float
    moving: bool

    @property
    def length(self) -> float:
        """Return the length of the span, s."""
        return self.end - self.start


def segments(channels: Mapping[str, Channel], lone: Mapping[str, Lone]) -> tuple[Segment, ...]:
    """Return when the IMU is still and when it moves; no segment if the record does not show it.

    Args:
        channels: its axes whose samples are not all equal.
        lone: the lone samples of each channel; they are not taken as motion.
    """
    axes = {axis: (channel.time, lone[axis].without(channel.values)) for axis, channel in channels.items()}
    record = identification.stillness(axes) if axes else None
    return () if record is None else tuple(_segments(record))


def _segments(record: identification.Stillness) -> Iterator[Segment]:
    """Yield the spans between the disturbances, and the disturbances, of each recorded part."""
    for begin, end in record.recorded:
        at = begin
        for span in record.disturbances:
            start, stop = max(span.start, at), min(span.end, end)
            if stop <= start:
                continue
            if start > at:
                yield Segment(at, start, moving=False)
            yield Segment(start, stop, moving=True)
            at = stop
        if end > at:
            yield Segment(at, end, moving=False)

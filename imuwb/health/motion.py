"""When an IMU is still and when it moves."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from imuwb import identification
from imuwb.arrays import Floats
from imuwb.health.channel import Channel
from imuwb.health.lone import Lone


@dataclass(frozen=True, slots=True)
class Segment:
    """A recorded span during which the IMU is still, or moves."""

    start: float  #: s from the log's start
    end: float
    moving: bool
    even: bool = False  #: moving, but so evenly that only a receiver or an odometer shows it

    @property
    def length(self) -> float:
        """Return the length of the span, s."""
        return self.end - self.start


def segments(channels: Mapping[str, Channel], lone: Mapping[str, Lone], travels: Floats) -> tuple[Segment, ...]:
    """Return when the IMU is still and when it moves; no segment if the record does not show it.

    Args:
        channels: its axes whose samples are not all equal.
        lone: the lone samples of each channel; they are not taken as motion.
        travels: (k, 2) s, spans in which the vehicle travels, as ``imuwb.navigation.travel`` finds them.
    """
    axes = {axis: (channel.time, lone[axis].without(channel.values)) for axis, channel in channels.items()}
    record = identification.stillness(axes, travels) if axes else None
    return () if record is None else tuple(_segments(record))


def _segments(record: identification.Stillness) -> Iterator[Segment]:
    """Yield the spans between the motions, and the motions, of each recorded part."""
    shaken = ((span.start, span.end, False) for span in record.disturbances)
    motions = sorted((*shaken, *((*span, True) for span in record.even)))
    for begin, end in record.recorded:
        at = begin
        for first, last, even in motions:
            start, stop = max(first, at), min(last, end)
            if stop <= start:
                continue
            if start > at:
                yield Segment(at, start, moving=False)
            yield Segment(start, stop, moving=True, even=even)
            at = stop
        if end > at:
            yield Segment(at, end, moving=False)

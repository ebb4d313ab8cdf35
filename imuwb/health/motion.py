"""When an IMU is still and when it moves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from imuwb.identification import stillness

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from imuwb.health.channel import Channel
    from imuwb.health.spikes import Lone
    from imuwb.identification import Stillness


@dataclass(frozen=True, slots=True)
class Segment:
    """A recorded span in which the IMU is still, or moves."""

    start: float  #: s from the log's start
    end: float
    moving: bool


def segments(channels: Mapping[str, Channel], lone: Mapping[str, Lone]) -> tuple[Segment, ...]:
    """Return when the IMU is still and when it moves; nothing where that cannot be told.

    Args:
        channels: its axes that change.
        lone: their lone samples, which are no motion.
    """
    axes = {axis: (channel.time, lone[axis].without(channel.values)) for axis, channel in channels.items()}
    found = stillness(axes) if axes else None
    return () if found is None else tuple(_parts(found))


def _parts(found: Stillness) -> Iterator[Segment]:
    for begin, end in found.recorded:
        at = begin
        for span in found.disturbances:
            start, stop = max(span.start, at), min(span.end, end)
            if stop <= start:
                continue
            if start > at:
                yield Segment(at, start, moving=False)
            yield Segment(start, stop, moving=True)
            at = stop
        if end > at:
            yield Segment(at, end, moving=False)

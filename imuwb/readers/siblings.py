"""Streams that belong together: a temperature to its IMU, a velocity to its receiver."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from imuwb.log import GnssStream, Repair

if TYPE_CHECKING:
    from collections.abc import Sequence

    from imuwb.log import Floats, Nanoseconds

MATCHED = 0.9  #: share of the fixes that must have a velocity of their own


def sibling(topic: str, names: Sequence[str]) -> str | None:
    """Return the name that shares most of its path with a topic; the only one, if it is; None where none shares any."""
    if len(names) == 1:
        return names[0]

    def shared(name: str) -> int:
        parts = zip(topic.split("/")[:-1], name.split("/")[:-1], strict=False)
        return sum(1 for a, b in parts if a == b and a)

    return max(names, key=shared) if names and max(map(shared, names)) else None


def with_velocity(
    streams: tuple[GnssStream, ...], topic: str, time: Nanoseconds, velocity: Floats
) -> tuple[tuple[GnssStream, ...], str]:
    """Return the receivers with a velocity stream joined to the one it is of, and a note about it.

    Each fix takes the velocity nearest in time, within half an interval of the fixes. Fixes that have none are left out
    if they are few; if they are many, the velocity is.
    """
    name = sibling(topic, [gnss.name for gnss in streams if gnss.velocity is None])
    gnss = next((gnss for gnss in streams if gnss.name == name), None)
    if gnss is None or not len(gnss):
        return streams, f"{topic}: velocity of no receiver in the log, left out"
    after = np.searchsorted(time, gnss.time).clip(1, max(time.size - 1, 1))
    before = after - 1
    after = np.minimum(after, time.size - 1)
    nearest = np.where(np.abs(time[after] - gnss.time) < np.abs(gnss.time - time[before]), after, before)
    interval = float(np.median(np.diff(gnss.time))) if len(gnss) > 1 else 0.0
    near = np.abs(time[nearest] - gnss.time) <= interval / 2
    if near.mean() < MATCHED:
        return streams, f"{topic}: only {near.sum()} of {len(gnss)} fixes of {gnss.name} have a velocity near; left out"
    lost = int(np.count_nonzero(~near))
    repairs = (
        *gnss.origin.repairs,
        *((Repair(f"fixes without a velocity of {topic} left out", lost),) if lost else ()),
    )

    def kept(values: Floats | None) -> Floats | None:
        return None if values is None else values[near]

    joined = GnssStream(
        gnss.name, gnss.time[near], gnss.position[near], velocity[nearest[near]], kept(gnss.position_sigma),
        kept(gnss.velocity_sigma), None if gnss.fix_type is None else gnss.fix_type[near],
        replace(gnss.origin, repairs=repairs),
    )  # fmt: skip
    return tuple(joined if s is gnss else s for s in streams), f"{topic}: taken as the velocity of {gnss.name}"

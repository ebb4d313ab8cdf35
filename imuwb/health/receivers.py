"""Faults of a GNSS receiver's fixes: held rows, flips of the fix, jumps and spikes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from imuwb.geodesy import radii_of_curvature
from imuwb.health.fault import Fault, runs

if TYPE_CHECKING:
    from collections.abc import Iterator

    from imuwb.log import Floats, GnssStream, Log

FIXED_3D = 3
FAST = 30.0  #: m/s by which a velocity may be off what positions say
JUMP = 20.0  #: m/s, besides the speed that is told, with which positions may step
HELD = 0.02  #: share of fixes that repeat the position before


def receiver_faults(log: Log, gnss: GnssStream) -> Iterator[Fault]:
    """Yield what is wrong with the fixes of a receiver."""
    time = log.seconds(gnss.time)
    if gnss.fix_type is not None:
        poor = gnss.fix_type < FIXED_3D
        first, length = runs(poor)
        if first.size:
            longest = int(np.argmax(length))
            last = min(first[longest] + length[longest], len(gnss) - 1)
            yield Fault(gnss.name, "fixes of less than three dimensions", "warning", int(poor.sum()), float(time[first[longest]]),
                        float(time[last] - time[first[longest]]), "not to be navigated by")  # fmt: skip
        flips = np.flatnonzero(np.diff(gnss.fix_type) != 0)
        if flips.size:
            yield Fault(gnss.name, "the kind of fix changes", "note", int(flips.size), float(time[flips[0] + 1]),
                        consequence="positions may step there")  # fmt: skip
    if len(gnss) < 3:  # noqa: PLR2004 - too few to compare
        return
    held = (np.diff(gnss.position, axis=0) == 0).all(axis=1)
    if held.mean() > HELD:
        yield Fault(gnss.name, "rows that hold the position before", "warning", int(held.sum()), float(time[int(np.argmax(held)) + 1]),
                    consequence="the receiver is slower than its rows: each fix is to be used once")  # fmt: skip
    yield from _steps(gnss, time, held)
    for what, sigma in (("position", gnss.position_sigma), ("velocity", gnss.velocity_sigma)):
        if sigma is None and getattr(gnss, what) is not None:
            yield Fault(
                gnss.name, f"no sigma of its {what} is told", "note", consequence="a filter needs one to be given"
            )


def _steps(gnss: GnssStream, time: Floats, held: Floats) -> Iterator[Fault]:
    steps = np.diff(time)
    meridian, transverse = radii_of_curvature(gnss.position[:-1, 0])
    turns = np.diff(gnss.position, axis=0)
    turns[:, 1] = (turns[:, 1] + np.pi) % (2 * np.pi) - np.pi  # over the date line
    moved = turns * np.stack([meridian, transverse * np.cos(gnss.position[:-1, 0]), -np.ones(steps.size)], axis=1)
    rate = moved / steps[:, None]
    pace = np.linalg.norm(rate[:, :2], axis=1)
    if gnss.velocity is None:
        usual = float(np.median(pace[~np.asarray(held, dtype=bool)])) if not np.all(held) else 0.0
        told = np.full(steps.size, usual)
    else:
        known = np.isfinite(gnss.velocity[:, :2]).all(axis=1)
        speed = np.linalg.norm(gnss.velocity[known, :2], axis=1)
        usual = float(np.median(pace)) if not speed.size else 0.0
        nearest = np.interp(time, time[known], speed) if speed.size else np.full(time.size, usual)
        told = np.maximum(nearest[:-1], nearest[1:])
        spikes = np.flatnonzero((speed[1:-1] > speed[:-2] + FAST) & (speed[1:-1] > speed[2:] + FAST)) + 1
        if spikes.size:
            yield Fault(gnss.name, f"spikes of the velocity, up to {speed[spikes].max():.3g} m/s", "fault", int(spikes.size),
                        float(time[known][spikes[0]]), consequence="a filter must gate them")  # fmt: skip
    jumps = np.flatnonzero(pace > 3 * told + JUMP)
    if jumps.size:
        far = float(np.linalg.norm(moved[jumps, :2], axis=1).max())
        yield Fault(gnss.name, f"steps of the position, up to {far:.3g} m", "fault", int(jumps.size), float(time[jumps[0] + 1]),
                    consequence="a filter must gate them")  # fmt: skip

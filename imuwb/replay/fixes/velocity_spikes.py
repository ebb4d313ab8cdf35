"""Lone velocities that no vehicle can have, found between their neighbours and left out.

A receiver that loses and regains a signal may report one velocity that is wrong by tens of m/s with a small sigma. A filter
refuses it, but whatever is estimated by a likelihood, such as a delay of the fixes, would explain it first.
"""

from dataclasses import replace

import numpy as np

from imuwb.log import SECOND, GnssStream
from imuwb.notes import Note

LARGEST = (
    50.0  #: m/s², five times gravity; no vehicle accelerates so from one fix to the next and brakes so to the one after
)
SIGMAS = 6.0  #: standard deviations of the difference that the receiver states
ALONE = 1.5  #: times as far off as its neighbours
FAR = 2.0  #: s; neighbours that are further away say nothing


def without_spikes(gnss: GnssStream) -> tuple[GnssStream, tuple[Note, ...]]:
    """Return a receiver without the velocities that differ from those before and after by more than a vehicle can.

    Args:
        gnss: the receiver; nothing changes without velocities.
    """
    if gnss.velocity is None or len(gnss) < 3:  # noqa: PLR2004 - both neighbours
        return gnss, ()
    time, velocity = gnss.time / SECOND, gnss.velocity
    before, after = time[1:-1] - time[:-2], time[2:] - time[1:-1]
    middle = (velocity[:-2] * after[:, None] + velocity[2:] * before[:, None]) / (before + after)[:, None]
    sigma = np.zeros_like(velocity) if gnss.velocity_sigma is None else np.nan_to_num(gnss.velocity_sigma)
    scatter = np.sqrt(sigma[1:-1] ** 2 + (sigma[:-2] ** 2 + sigma[2:] ** 2) / 2)
    least = LARGEST * np.maximum(before, after)[:, None] + SIGMAS * scatter
    spikes = np.zeros(len(gnss), dtype=bool)
    near = np.maximum(before, after) < FAR
    spikes[1:-1] = near & (np.abs(velocity[1:-1] - middle) > least).any(axis=1)
    # The neighbours of a spike, compared with it, are off by half as much; on both sides of a step, both are off equally.
    off = np.zeros(len(gnss))
    off[1:-1] = np.nan_to_num(np.abs(velocity[1:-1] - middle)).max(axis=1)
    spikes[1:-1] &= off[1:-1] > ALONE * np.maximum(off[:-2], off[2:])
    count = int(np.count_nonzero(spikes))
    if not count:
        return gnss, ()
    text = f"{gnss.name}: {count} lone velocities differ from those before and after by up to {off[spikes].max():.0f} m/s; they are not used"
    cleaned = np.where(spikes[:, None], np.nan, velocity)
    return replace(gnss, velocity=cleaned), (Note("velocity-spikes", text),)

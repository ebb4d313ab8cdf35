"""Scores of several logs as one: the logs lie far apart in time, so that no outages and no blocks of neighbours cross them."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.replay.scoring.scores import Scores

APART = 1e8  #: s between the starts of two logs; an outage of a log begins earlier than half of it


def pooled(parts: Sequence[Scores]) -> Scores:
    """Return the scores of several logs as one; ``start`` of the k-th log is later by k times ``APART``.

    Args:
        parts: of one filter, with outages of one duration.
    """
    return joined([replace(part, start=part.start + k * APART) for k, part in enumerate(parts)])


def joined(parts: Sequence[Scores]) -> Scores:
    """Return scores of one duration in other outages as one.

    Args:
        parts: in order of time.
    """
    north_east, covariance, vertical, velocity, heading, distance = (
        np.concatenate([getattr(part, name) for part in parts])
        for name in ("north_east", "covariance", "vertical", "velocity", "heading", "distance")
    )
    extents = [part.discrepancy for part in parts]
    known = [extent for extent in extents if extent is not None]
    return Scores(
        np.concatenate([part.start for part in parts]), parts[0].elapsed, north_east, covariance, vertical, velocity, heading, distance,
        np.concatenate(known) if len(known) == len(extents) else None,
    )  # fmt: skip


def logs_of(start: Floats) -> list[Integers]:
    """Return the rows of each log among outages that begin at some times, in order of time."""
    return [
        part for part in np.split(np.arange(start.size), np.flatnonzero(np.diff(start) > APART / 2) + 1) if part.size
    ]

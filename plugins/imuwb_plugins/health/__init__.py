"""Faults of a log: gaps, stuck or saturated channels, spikes, wrong gravity, with time, count and consequence.

A verdict for each stream, its rate over time, when the IMU is still and when it moves, and the tracks.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

if TYPE_CHECKING:
    from collections.abc import Sequence

    from imuwb.analysis import Review
    from imuwb.health import Health
    from imuwb.log import Log

__all__ = ["SHOWS_FAULTS", "Parameters", "draw", "run"]

SHOWS_FAULTS = True


@dataclass(frozen=True)
class Parameters:
    """Options of ``imuwb health``."""

    lines: Annotated[bool, "look for periodic lines"] = True


def run(logs: Sequence[Log], parameters: Parameters) -> Health:
    """Return what is wrong with the log.

    Raises:
        MissingDataError: it has no stream that can be used.
    """
    from imuwb.health import check  # noqa: PLC0415 - help must not wait for numpy

    logs[0].streams()
    return check(logs[0], lines=parameters.lines)


def draw(result: Health, review: Review) -> None:
    """Show verdicts, faults, rates over time, and when the IMU moves."""
    from imuwb_plugins.health import show  # noqa: PLC0415 - as above

    show.draw(result, review)

"""Least-squares spectrum: lines of unevenly spaced, coloured series with intervals, and what the noise is.

Vanicek's spectrum with known constituents estimated together with every line, significance at one frequency and in the whole
record, and tests whether the noise is a random walk or autoregressive (Pagiatakis; El-Diasty and others).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from imuwb_plugins.lssa.parameters import Parameters

if TYPE_CHECKING:
    from collections.abc import Sequence

    from imuwb.analysis import Finding, Review
    from imuwb.log import Log
    from imuwb_plugins.lssa.result import Result

__all__ = ["Parameters", "draw", "findings", "run"]


def run(logs: Sequence[Log], parameters: Parameters) -> Result:
    """Return the result for each axis of the log's IMU."""
    from imuwb_plugins.lssa import compute  # noqa: PLC0415 - help must not wait for numpy

    return compute.run(logs, parameters)


def draw(result: Result, review: Review) -> None:
    """Show spectra with their limits, lines and tests."""
    from imuwb_plugins.lssa import show  # noqa: PLC0415 - as above

    show.draw(result, review)


def findings(result: Result) -> tuple[Finding, ...]:
    """Return the lines of each axis."""
    from imuwb_plugins.lssa import compute  # noqa: PLC0415 - as above

    return compute.findings(result)

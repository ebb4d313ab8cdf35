"""Power spectral density: N, B, K, Q with intervals, lines, slopes.

Welch's method with segments of up to 2^20 samples, averaged over bands of frequency, and the sum of processes
fitted to it by likelihood. Densities are one-sided.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from imuwb_plugins.psd.parameters import Parameters

if TYPE_CHECKING:
    from collections.abc import Sequence

    from imuwb.analysis import Finding, Review
    from imuwb.log import Log
    from imuwb_plugins.psd.result import Result

__all__ = ["Parameters", "draw", "findings", "run"]


def run(logs: Sequence[Log], parameters: Parameters) -> Result:
    """Return the result for each axis of the log's IMU."""
    from imuwb_plugins.psd import compute  # noqa: PLC0415 - help must not wait for numpy

    return compute.run(logs, parameters)


def draw(result: Result, review: Review) -> None:
    """Show figures, tables and notes."""
    from imuwb_plugins.psd import show  # noqa: PLC0415 - as above

    show.draw(result, review)


def findings(result: Result) -> tuple[Finding, ...]:
    """Return what is said of each axis."""
    from imuwb_plugins.psd import compute  # noqa: PLC0415 - as above

    return compute.findings(result)

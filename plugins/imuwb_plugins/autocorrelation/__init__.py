"""Autocorrelation, before and after denoising, and whether first-order Gauss-Markov is tenable.

By fast Fourier transform, normalised, with the band of white noise; the likeliest Gauss-Markov process (sigma, Tc)
and a test of it. Denoising shows what the white noise hides.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from imuwb_plugins.autocorrelation.parameters import Parameters

if TYPE_CHECKING:
    from collections.abc import Sequence

    from imuwb.analysis import Finding, Review
    from imuwb.log import Log
    from imuwb_plugins.autocorrelation.result import Result

__all__ = ["Parameters", "draw", "findings", "run"]


def run(logs: Sequence[Log], parameters: Parameters) -> Result:
    """Return the result for each axis of the log's IMU."""
    from imuwb_plugins.autocorrelation import compute  # noqa: PLC0415 - help must not wait for numpy

    return compute.run(logs, parameters)


def draw(result: Result, review: Review) -> None:
    """Show figures, tables and notes."""
    from imuwb_plugins.autocorrelation import show  # noqa: PLC0415 - as above

    show.draw(result, review)


def findings(result: Result) -> tuple[Finding, ...]:
    """Return what is said of each axis."""
    from imuwb_plugins.autocorrelation import compute  # noqa: PLC0415 - as above

    return compute.findings(result)

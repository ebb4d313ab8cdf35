"""Wavelet denoising: SURE, universal or Bayes thresholds, of the whole record or in a window that slides behind."""

from __future__ import annotations

from typing import TYPE_CHECKING

from imuwb_plugins.wavelet.parameters import Parameters

if TYPE_CHECKING:
    from imuwb.analysis import Review
    from imuwb.log import Log
    from imuwb_plugins.wavelet.apply import Applied

__all__ = ["Parameters", "condition", "draw"]


def condition(log: Log, parameters: Parameters) -> tuple[Log, Applied]:
    """Return the log with its IMUs denoised, and how."""
    from imuwb_plugins.wavelet import apply  # noqa: PLC0415 - help must not wait for numpy

    return apply.condition(log, parameters)


def draw(found: Applied, review: Review) -> None:
    """Show levels, band limits and thresholds (Quinchia, table 7)."""
    from imuwb_plugins.wavelet import apply  # noqa: PLC0415 - as above

    apply.draw(found, review)

"""Bias, scale factors and cross-couplings from nine or more still positions, of known or unknown attitudes.

Without --attitudes nothing is known but that each position feels one gravity; the x axis then is the x accelerometer's.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from imuwb_plugins.calibration.parameters import MultiPosition as Parameters

if TYPE_CHECKING:
    from collections.abc import Sequence

    from imuwb.analysis import Review
    from imuwb.log import Log
    from imuwb.stochastic import ImuErrorModel
    from imuwb_plugins.calibration.result import PositionResult

__all__ = ["LEAVES_MODEL", "LOGS", "Parameters", "draw", "error_model", "run"]

LOGS = (1, None)
LEAVES_MODEL = "calibration"


def run(logs: Sequence[Log], parameters: Parameters) -> PositionResult:
    """Return what the positions tell."""
    from imuwb_plugins.calibration import compute  # noqa: PLC0415 - help must not wait for numpy

    return compute.multi_position(logs, parameters)


def draw(result: PositionResult, review: Review) -> None:
    """Show parameters, residuals by position, and samples raw and corrected."""
    from imuwb_plugins.calibration import show  # noqa: PLC0415 - as above

    show.positions(result, review)


def error_model(result: PositionResult) -> ImuErrorModel:
    """Return the model whose deterministic terms were found."""
    return result.model

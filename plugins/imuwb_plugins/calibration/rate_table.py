"""Gyros on a rate table: bias, scale factor, its non-linear part and cross-couplings (Hassaballa, 3.1).

A log for each axis, or several; the steps of the staircase are found, and matched to --rates, clockwise and counter-clockwise.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from imuwb_plugins.calibration.parameters import RateTable as Parameters

if TYPE_CHECKING:
    from collections.abc import Sequence

    from imuwb.analysis import Review
    from imuwb.log import Log
    from imuwb.stochastic import ImuErrorModel
    from imuwb_plugins.calibration.result import TableResult

__all__ = ["LEAVES_MODEL", "LOGS", "Parameters", "draw", "error_model", "run"]

LOGS = (1, None)
LEAVES_MODEL = "calibration"


def run(logs: Sequence[Log], parameters: Parameters) -> TableResult:
    """Return what the runs tell."""
    from imuwb_plugins.calibration import turned  # noqa: PLC0415 - help must not wait for numpy

    return turned.run(logs, parameters)


def draw(result: TableResult, review: Review) -> None:
    """Show parameters, steps with residuals, and samples raw and corrected."""
    from imuwb_plugins.calibration import show_table  # noqa: PLC0415 - as above

    show_table.draw(result, review)


def error_model(result: TableResult) -> ImuErrorModel:
    """Return the model whose deterministic terms were found."""
    return result.model

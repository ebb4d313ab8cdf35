"""Allan deviation: noise coefficients Q, N, B, K, R with intervals.

Overlapping Allan deviation of all axes with intervals, one fit of the whole sum of processes, and the
slopes that free lines have where one process rules.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from imuwb_plugins.allan.parameters import Parameters

if TYPE_CHECKING:
    from collections.abc import Sequence

    from imuwb.analysis import Finding, Review
    from imuwb.log import Log
    from imuwb.stochastic import ImuErrorModel
    from imuwb_plugins.allan.result import Result

__all__ = ["Parameters", "draw", "error_model", "findings", "run"]


def run(logs: Sequence[Log], parameters: Parameters) -> Result:
    """Return the Allan deviations and fits of the log's IMU."""
    from imuwb_plugins.allan import compute  # noqa: PLC0415 - help must not wait for numpy

    return compute.run(logs, parameters)


def draw(result: Result, review: Review) -> None:
    """Show figures, tables and notes."""
    from imuwb_plugins.allan import show  # noqa: PLC0415 - as above

    show.draw(result, review)


def error_model(result: Result) -> ImuErrorModel:
    """Return the fitted sums as an error model."""
    from imuwb_plugins.allan import compute  # noqa: PLC0415 - as above

    return compute.error_model(result)


def findings(result: Result) -> tuple[Finding, ...]:
    """Return what each estimator says of each axis, and remarks to act on."""
    from imuwb_plugins.allan import remarks  # noqa: PLC0415 - as above

    return remarks.findings(result)

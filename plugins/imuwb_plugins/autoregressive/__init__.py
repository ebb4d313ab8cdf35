"""Autoregressive models of all orders by Burg's method, with standard errors and poles.

x(n) = -sum alpha_k x(n-k) + beta0 w(n). Orders are compared by AICc, BIC and FPE, coefficients tested at 99 %,
and innovations for whiteness. Use --through wavelet:levels=6 to model what denoising leaves, as the papers do.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from imuwb_plugins.autoregressive.parameters import Parameters

if TYPE_CHECKING:
    from collections.abc import Sequence

    from imuwb.analysis import Finding, Review
    from imuwb.log import Log
    from imuwb.stochastic import ImuErrorModel
    from imuwb_plugins.autoregressive.result import Result

__all__ = ["Parameters", "draw", "error_model", "findings", "run"]


def run(logs: Sequence[Log], parameters: Parameters) -> Result:
    """Return the result for each axis of the log's IMU."""
    from imuwb_plugins.autoregressive import compute  # noqa: PLC0415 - help must not wait for numpy

    return compute.run(logs, parameters)


def draw(result: Result, review: Review) -> None:
    """Show figures, tables and notes."""
    from imuwb_plugins.autoregressive import show  # noqa: PLC0415 - as above

    show.draw(result, review)


def findings(result: Result) -> tuple[Finding, ...]:
    """Return what is said of each axis."""
    from imuwb_plugins.autoregressive import compute  # noqa: PLC0415 - as above

    return compute.findings(result)


def error_model(result: Result) -> ImuErrorModel:
    """Return the models of the chosen order."""
    from imuwb_plugins.autoregressive import compute  # noqa: PLC0415 - as above

    return compute.error_model(result)

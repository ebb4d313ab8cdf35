"""Noise and bias by temperature: N, B, K, AR(1) at each set-point, whether they depend on it, and a model of it.

One log a set-point, or one that has plateaus or ramps. At each temperature the coefficients with intervals, for each a test of
"the same at all temperatures" and a function of temperature chosen by cross-validation; the model holds them all.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from imuwb_plugins.temperature.parameters import Parameters

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from imuwb.analysis import Case, Review
    from imuwb.log import Log
    from imuwb.stochastic import ImuErrorModel
    from imuwb_plugins.temperature.result import Result, Study

__all__ = ["LEAVES_MODEL", "LOGS", "Parameters", "draw", "draw_study", "error_model", "run", "study"]

LOGS = (1, None)
LEAVES_MODEL = True


def run(logs: Sequence[Log], parameters: Parameters) -> Result:
    """Return what each axis does over temperature.

    Raises:
        MissingDataError: a log without temperature, or that moves; one temperature only.
        UsageError: logs that do not belong together, or options that do not suit them.
    """
    from imuwb_plugins.temperature import compute  # noqa: PLC0415 - help must not wait for numpy

    return compute.run(logs, parameters)


def draw(result: Result, review: Review) -> None:
    """Show figures, tables and notes."""
    from imuwb_plugins.temperature import show  # noqa: PLC0415 - as above

    show.draw(result, review)


def error_model(result: Result) -> ImuErrorModel:
    """Return the model: processes and bias as functions of temperature."""
    from imuwb_plugins.temperature import model  # noqa: PLC0415 - as above

    return model.error_model(result)


def study(cases: Iterable[Case], parameters: Parameters) -> Study:
    """Return AR(1) by temperature in each setting, such as a filter's cut-off."""
    from imuwb_plugins.temperature import settings  # noqa: PLC0415 - as above

    return settings.study(cases, parameters)


def draw_study(result: Study, review: Review) -> None:
    """Show AR(1) by temperature and by setting."""
    from imuwb_plugins.temperature import show_study  # noqa: PLC0415 - as above

    show_study.draw(result, review)

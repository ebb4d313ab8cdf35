"""The error model of an Allan analysis."""

import math
from collections.abc import Mapping

from imuwb import __version__
from imuwb.errors import MissingDataError
from imuwb.statistics import Coefficient
from imuwb.stochastic import AxisModel, ImuErrorModel, Sum, of_either_sign
from imuwb_plugins.allan.result import AllanAxis, Result


def error_model(result: Result) -> ImuErrorModel:
    """Return the identified sums, with the intervals of their terms and the limits of the terms that are absent.

    Raises:
        MissingDataError: no axis has a fit.
    """
    headline = result.model == "headline"
    axes = {axis: _model(r, headline=headline) for axis, r in result.axes.items() if r.processes is not None}
    if not axes:
        raise MissingDataError(f"{result.imu}: no axis could be fitted, so there is no error model to save")
    how = (
        "likelihood where a record allows it, else Allan variance"
        if headline and any(r.estimates for r in result.axes.values())
        else "Allan variance"
    )
    rates = ", ".join(f"{sensor} {rate:.6g} Hz" for sensor, rate in result.rate_hz.items())
    analysis = f"imuwb {__version__} allan, by {how}, {100 * result.level:g} % intervals"
    return ImuErrorModel(result.imu, axes, {"log": result.source, "analysis": analysis, "rate": rates})


def _model(axis: AllanAxis, *, headline: bool) -> AxisModel:
    estimates = axis.estimates
    if not headline or estimates is None:
        return _axis_model(axis.processes or Sum(), axis.coefficients)
    return _axis_model(estimates.processes, estimates.by[estimates.headline] if estimates.intervals_apply else {})


def _axis_model(processes: Sum, coefficients: Mapping[str, Coefficient]) -> AxisModel:
    sure = {letter: c for letter, c in coefficients.items() if c.value is not None and c.lower}
    intervals = {
        f"{i}.{letter}": of_either_sign(getattr(term, letter), c.lower or 0.0, c.upper)
        for i, term in enumerate(processes.terms)
        for letter, c in sure.items()
        if hasattr(term, letter)
    }
    limits = {x: c.upper for x, c in coefficients.items() if x not in sure and 0 < c.upper < math.inf}
    return AxisModel(processes, intervals, limits)

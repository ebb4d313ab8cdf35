"""From a log to autocorrelations."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

import numpy as np

from imuwb.analysis import Finding
from imuwb.conditioning import denoise
from imuwb.errors import MissingDataError
from imuwb.identification import autocorrelation
from imuwb.identification.suitable import longest_part, unsuitable
from imuwb.sampling import Sampling, sampling
from imuwb.units import coefficient_units
from imuwb_autocorrelation.result import AxisResult, Curve, Result

if TYPE_CHECKING:
    from collections.abc import Sequence

    from imuwb.identification import Autocorrelation
    from imuwb.log import Floats, Log
    from imuwb_autocorrelation.parameters import Parameters

FEWEST = 256  #: samples


def run(logs: Sequence[Log], parameters: Parameters) -> Result:
    """Return the autocorrelations of the log's (first) IMU."""
    log = logs[0]
    imu = log.imu()
    axes = imu.axes()
    clocks = {sensor: sampling(axes[f"{sensor}_x"][0]) for sensor in ("gyro", "accel") if f"{sensor}_x" in axes}

    def analyse(axis: str) -> AxisResult:
        return _axis(axis, axes[axis][1], clocks[axis.partition("_")[0]], parameters)

    with ThreadPoolExecutor(2) as pool:
        results = dict(zip(axes, pool.map(analyse, axes), strict=True))
    if all(r.why_none for r in results.values()):
        message = f"{log.provenance.path}: {imu.name}: no axis has an autocorrelation: {next(iter(results.values())).why_none}"
        raise MissingDataError(message)
    notes = [
        f"{sensor}: {len(clock.breaks)} gaps; the autocorrelation is of the longest part without"
        for sensor, clock in clocks.items()
        if clock.breaks
    ]
    notes += [f"{axis}: {r.why_none}" for axis, r in results.items() if r.why_none]
    intervals = {sensor: clock.interval for sensor, clock in clocks.items()}
    return Result(imu.name, parameters.level, parameters.denoise, intervals, results, tuple(notes))


def _axis(axis: str, values: Floats, clock: Sampling, parameters: Parameters) -> AxisResult:
    unit = coefficient_units(axis, "rate")[0].name
    series = np.ascontiguousarray(values[longest_part(values, clock.breaks)])
    why = unsuitable(series, FEWEST)
    if why is not None:
        return AxisResult(np.empty(0), np.empty(0), None, None, None, None, None, unit, why)
    found = autocorrelation(series, clock.interval, parameters.longest, level=parameters.level)
    after: Curve | None = None
    if parameters.denoise:
        try:
            quiet = denoise(series, parameters.denoise).values
            after = _curve(autocorrelation(quiet, clock.interval, parameters.longest, level=parameters.level))
        except ValueError as error:
            why = f"not denoised: {error}"
    return AxisResult(
        found.lag, found.value, found.band, found.variance**0.5, found.falls_to, found.gauss_markov, after, unit, why
    )


def _curve(found: Autocorrelation) -> Curve:
    return Curve(found.lag, found.value, found.band, found.variance**0.5, found.falls_to, found.gauss_markov)


def findings(result: Result) -> tuple[Finding, ...]:
    """Return whether a first-order Gauss-Markov process is tenable."""
    return tuple(
        Finding(axis, "autocorrelation", {}, (verdict(found, result.interval[axis.partition("_")[0]]),))
        for axis, found in result.axes.items()
        if found.gauss_markov is not None
    )


def verdict(found: AxisResult, interval: float) -> str:
    """Return in words whether the series is white, a first-order Gauss-Markov process, or neither."""
    fitted = found.gauss_markov
    if fitted is None:
        return "no verdict"
    if fitted.tenable and fitted.Tc < interval:
        return "white: no correlation from one sample to the next"
    if fitted.tenable:
        return f"first-order Gauss-Markov alone is tenable: sigma {fitted.sigma:.3g} {found.unit}, Tc {fitted.Tc:.3g} s"
    return "not a first-order Gauss-Markov process alone"

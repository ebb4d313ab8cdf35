"""From a log to autocorrelations."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from imuwb.analysis import Finding
from imuwb.axes import axes_of, for_each, gap_notes, rates
from imuwb.conditioning import denoise
from imuwb.errors import MissingDataError
from imuwb.identification import autocorrelation
from imuwb.identification.record.suitable import unsuitable
from imuwb.units import coefficient_units
from imuwb_plugins.autocorrelation.result import AxisResult, Curve, Result

if TYPE_CHECKING:
    from collections.abc import Sequence

    from imuwb.axes import Axis
    from imuwb.identification import Autocorrelation
    from imuwb.log import Log
    from imuwb_plugins.autocorrelation.parameters import Parameters

FEWEST = 256  #: samples


def run(logs: Sequence[Log], parameters: Parameters) -> Result:
    """Return the autocorrelations of the log's (first) IMU."""
    log = logs[0]
    imu = log.imu()
    axes = axes_of(imu)
    results = for_each(axes, lambda axis: _axis(axis, parameters))
    if all(r.why_none for r in results.values()):
        message = f"{log.provenance.path}: {imu.name}: no axis has an autocorrelation: {next(iter(results.values())).why_none}"
        raise MissingDataError(message)
    notes = [
        *gap_notes(axes, "the autocorrelation"),
        *(f"{name}: {r.why_none}" for name, r in results.items() if r.why_none),
    ]
    short = [name for name, r in results.items() if r.lag.size and r.denoised is None]
    if short and parameters.denoise:
        notes.append(
            f"{', '.join(short)}: too short for {parameters.denoise} levels of denoising; --denoise takes fewer"
        )
    intervals = {sensor: 1 / rate for sensor, rate in rates(axes).items()}
    return Result(imu.name, parameters.level, parameters.denoise, intervals, results, tuple(notes))


def _axis(axis: Axis, parameters: Parameters) -> AxisResult:
    unit = coefficient_units(axis.name, "rate")[0].name
    series, dt = axis.longest, axis.clock.interval
    why = unsuitable(series, FEWEST)
    if why is not None:
        return AxisResult(np.empty(0), np.empty(0), None, None, None, None, None, unit, why)
    found = autocorrelation(series, dt, parameters.longest, level=parameters.level)
    after: Curve | None = None
    if parameters.denoise:
        try:
            quiet = denoise(series, parameters.denoise).values
            after = _curve(autocorrelation(quiet, dt, parameters.longest, level=parameters.level))
        except ValueError:
            after = None  # too short for so many levels; the note says so
    return AxisResult(
        found.lag, found.value, found.band, found.variance**0.5, found.falls_to, found.gauss_markov, after, unit, None
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

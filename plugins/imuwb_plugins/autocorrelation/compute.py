"""From a log to autocorrelations."""

from collections.abc import Mapping, Sequence

import numpy as np

from imuwb.analysis import Finding
from imuwb.arrays import Floats, alone
from imuwb.axes import Axis, axes_of, for_each, gap_notes, rates
from imuwb.conditioning import denoise
from imuwb.identification import GaussMarkovFit, autocorrelation
from imuwb.identification.record.suitable import unsuitable
from imuwb.log import Log
from imuwb.noise_results import missing_notes
from imuwb.notes import Note
from imuwb.units import coefficient_units
from imuwb_plugins.autocorrelation.parameters import Parameters
from imuwb_plugins.autocorrelation.result import (
    NO_VERDICT,
    CorrelationAxis,
    CorrelationCurve,
    Result,
)

FEWEST = 256  #: samples


def run(logs: Sequence[Log], parameters: Parameters) -> Result:
    """Return the autocorrelations of the log's (first) IMU.

    Raises:
        MissingDataError: no axis has an autocorrelation.
    """
    log = logs[0]
    imu = log.imu()
    axes = axes_of(imu)
    results = for_each(axes, lambda axis: _axis(axis, parameters))
    reasons = {name: r.why_none for name, r in results.items()}
    missing = missing_notes(log, reasons, "no-correlation", "an autocorrelation")
    intervals = {sensor: 1 / rate for sensor, rate in rates(axes).items()}
    notes = (*gap_notes(axes, "the autocorrelation"), *missing, *_notes(results, parameters.denoise))
    return Result(imu.name, parameters.level, parameters.denoise, intervals, results, notes)


def _notes(results: Mapping[str, CorrelationAxis], levels: int) -> list[Note]:
    short = [name for name, r in results.items() if r.lag.size and r.denoised is None]
    if not short or not levels:
        return []
    text = f"{', '.join(short)}: the record is too short for {levels} levels of denoising; give --denoise fewer"
    return [Note("not-denoised", text)]


def _axis(axis: Axis, parameters: Parameters) -> CorrelationAxis:
    unit = coefficient_units(axis.name, "rate")[0].name
    series, dt = axis.values[axis.longest_rows], axis.clock.interval
    why = unsuitable(series, FEWEST)
    if why is not None:
        return CorrelationAxis(np.empty(0), np.empty(0), unit=unit, why_none=why)
    curve = _curve(series, dt, parameters)
    after: CorrelationCurve | None = None
    if parameters.denoise:
        try:
            with alone(series.size):
                after = _curve(denoise(series, parameters.denoise).values, dt, parameters)
        except ValueError:
            after = None  # the record is too short for so many levels, which a note reports
    return CorrelationAxis(
        curve.lag, curve.value, curve.band, curve.deviation, curve.falls_to, curve.gauss_markov, None, unit,
        _verdict(curve.gauss_markov, dt, unit), after,
    )  # fmt: skip


def _curve(series: Floats, dt: float, parameters: Parameters) -> CorrelationCurve:
    a = autocorrelation(series, dt, parameters.longest, level=parameters.level)
    model = None if a.gauss_markov is None else np.exp(-a.lag / a.gauss_markov.Tc.value)
    return CorrelationCurve(a.lag, a.value, a.band, a.variance**0.5, a.falls_to, a.gauss_markov, model)


def _verdict(fit: GaussMarkovFit | None, interval: float, unit: str) -> Note:
    """Return whether the series is white, a first-order Gauss-Markov process, or neither."""
    if fit is None:
        return NO_VERDICT
    if not fit.tenable:
        return Note("untenable", "not a first-order Gauss-Markov process alone")
    if fit.Tc.value < interval:
        return Note("white", "white: no correlation from one sample to the next")
    text = f"a first-order Gauss-Markov process alone is tenable: sigma {fit.sigma.value:.3g} {unit}, Tc {fit.Tc.value:.3g} s"
    return Note("tenable", text)


def findings(result: Result) -> tuple[Finding, ...]:
    """Return whether a first-order Gauss-Markov process is tenable, axis by axis."""
    return tuple(
        Finding(axis, "autocorrelation", {}, (r.verdict,))
        for axis, r in result.axes.items()
        if r.gauss_markov is not None
    )

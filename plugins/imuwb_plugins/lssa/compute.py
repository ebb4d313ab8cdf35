"""From a log to spectra, lines and tests."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, cast

import numpy as np

from imuwb.analysis import Finding
from imuwb.axes import axes_of, for_each
from imuwb.errors import MissingDataError, UsageError
from imuwb.identification import power_spectrum
from imuwb.identification.lssa import (
    Constituents,
    Noise,
    adjust,
    drifting_lines,
    extract,
    is_autoregressive,
    is_random_walk,
    least_squares_spectrum,
    usable_band,
    words,
)
from imuwb.identification.record.suitable import unsuitable
from imuwb.log import SECOND
from imuwb.sampling import longest_part
from imuwb.statistics.distributions import normal_limit, student_limit
from imuwb_plugins.lssa.result import AxisResult, ConstituentResult, HypothesisResult, PeakResult, Result

if TYPE_CHECKING:
    from collections.abc import Sequence

    from imuwb.axes import Axis
    from imuwb.identification.lssa import Extraction, Hypothesis, Kind, Significance, Spectrum
    from imuwb.log import Floats, Log
    from imuwb_plugins.lssa.parameters import Parameters

FEWEST = 256  #: samples
BINS = 1500  #: of frequency, equally wide in its logarithm, that are drawn
HARMONIC = 0.01  #: of a multiple, by which a harmonic may miss it
SLOW = 8  #: cycles over the record, up to which noise disturbs a level or a trend
NONE = np.empty(0)


def run(logs: Sequence[Log], parameters: Parameters) -> Result:
    """Return the spectra of the log's (first) IMU."""
    log = logs[0]
    imu = log.imu()
    axes = axes_of(imu)
    constituents = Constituents(
        parameters.trend, parameters.numbers("jumps", least=-np.inf), parameters.numbers("forced"),
        parameters.numbers("exponentials"),
    )  # fmt: skip
    noise = _noise(parameters)
    zero = log.zero or 0
    _check_forced(log, axes, constituents)
    results = for_each(axes, lambda axis: _axis(axis, parameters, constituents, noise, zero, log.band))
    if all(r.why_none for r in results.values()):
        message = f"{log.provenance.path}: {imu.name}: no axis has a spectrum: {next(iter(results.values())).why_none}"
        raise MissingDataError(message)
    notes = [f"{name}: {r.why_none}" for name, r in results.items() if r.why_none]
    notes += _band_notes(results, parameters)
    return Result(
        imu.name, parameters.level, parameters.confidence, parameters.noise, parameters.scale, results, tuple(notes)
    )


def _noise(parameters: Parameters) -> Noise:
    kind, order, correlation_time, file = parameters.structure()
    if not file:
        return Noise(cast("Kind", kind), order, correlation_time)
    try:
        covariance = np.asarray(np.load(Path(file), allow_pickle=False)).astype(float, casting="same_kind")
    except (OSError, EOFError, ValueError, TypeError) as error:
        message = f"--noise covariance:{file}: cannot be read as one array of numbers (.npy): {error}"
        raise UsageError(message) from error
    if covariance.ndim != 2:  # noqa: PLR2004 - rows and columns
        message = f"--noise covariance:{file}: an array of shape {covariance.shape}; a covariance is square, n x n"
        raise UsageError(message)
    return Noise("covariance", covariance=covariance)


def _check_forced(log: Log, axes: dict[str, Axis], constituents: Constituents) -> None:
    """Refuse a line of which the record holds no cycle."""
    for axis in axes.values():
        span = float(axis.time[-1] - axis.time[0]) / SECOND
        for frequency in constituents.forced:
            if frequency * span < 1:
                message = (
                    f"{log.provenance.path}: --forced {frequency:g}: a period of {1 / frequency:g} s, but {axis.sensor} has "
                    f"{span:g} s: it must hold one at least; a drift so slow is a trend (--trend quadratic)"
                )
                raise MissingDataError(message)


def _axis(
    axis: Axis, parameters: Parameters, constituents: Constituents, noise: Noise, zero: int, band: float
) -> AxisResult:
    why = unsuitable(axis.values, FEWEST)  # gaps do no harm
    if why is not None:
        return _nothing(why)
    time = (axis.time - zero) / SECOND
    try:
        adjusted = adjust(time, axis.values, constituents, noise, interval=axis.clock.interval)
        usable = usable_band(adjusted)
        highest = min(x for x in (parameters.highest, band, usable.highest) if x is not None)
        spectrum = least_squares_spectrum(adjusted, highest=highest, oversampling=parameters.oversampling)
        part, series = _longest(axis, time, constituents)
    except ValueError as error:
        return _nothing(str(error))
    found = extract(spectrum, parameters.level, parameters.confidence, parameters.peaks)
    chosen = _chosen(found)
    shown, one, record = _scaled(spectrum, found.left_found, parameters.scale, chosen)
    local = noise.kind == "local"
    critical = (None, None) if local else tuple(100 * s for s in found.found.share_limit(adjusted.freedom))
    frequency, density = _fourier(axis)
    lines = _named(_lines(series, axis.clock.interval, found, parameters, highest))
    noise_alone = _without_lines(series, adjusted.time[part], lines)
    return AxisResult(
        spectrum.frequency[chosen], spectrum.percent[chosen], spectrum.density[chosen], shown, one, record, frequency, density,
        critical[0], critical[1], lines, _constituents(spectrum, parameters.confidence),
        _hypotheses(noise_alone, parameters), tuple(float(a) for a in adjusted.noise.alpha),
        adjusted.noise.correlation_time, spectrum.frequency.size, usable.lowest, usable.highest, usable.mirror, None,
    )  # fmt: skip


def _nothing(why: str) -> AxisResult:
    return AxisResult(
        NONE, NONE, NONE, NONE, NONE, NONE, NONE, NONE, None, None, (), (), (), (), None, 0, 0.0, 0.0, None, why
    )


def _fourier(axis: Axis) -> tuple[Floats, Floats]:
    """Return Welch's spectrum of the longest part without gaps, where that is long enough."""
    if unsuitable(axis.longest, FEWEST) is not None:
        return NONE, NONE
    found = power_spectrum(axis.longest, axis.clock.interval)
    return found.frequency, found.density


def _chosen(found: Extraction) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    """Return the indices that are drawn: in each bin of frequencies where the exceedance is highest."""
    frequency, exceedance = found.spectrum.frequency, found.found.exceedance
    edges = np.geomspace(frequency[0], frequency[-1], BINS + 1)
    starts = np.unique(np.searchsorted(frequency, edges[:-1]))
    ends = np.append(starts[1:], frequency.size)
    return np.array([a + int(np.argmax(exceedance[a:b])) for a, b in zip(starts, ends, strict=True)])


def _scaled(
    spectrum: Spectrum, found: Significance, scale: str, chosen: np.ndarray[tuple[int], np.dtype[np.int64]]
) -> tuple[Floats, Floats, Floats]:
    """Return the spectrum and both its limits in the scale asked for."""
    if scale == "density":
        whole = spectrum.density, found.limit(spectrum, found.one), found.limit(spectrum, found.record)
    else:
        rest = spectrum.adjusted.rest
        shares = [found.reduction(spectrum, x) / rest for x in (found.one, found.record)]
        if scale == "percent":
            whole = spectrum.percent, 100 * shares[0], 100 * shares[1]
        elif scale == "decibels":
            whole = (
                spectrum.decibels,
                *(10 * np.log10(np.clip(s / (1 - np.minimum(s, 0.999)), 1e-30, None)) for s in shares),
            )
        else:
            whole = spectrum.printed_density, *(s * rest / spectrum.frequency for s in shares)
    # Limits are those of all frequencies in a bin, on the average.
    edges = np.concatenate([[0], (chosen[1:] + chosen[:-1] + 1) // 2])
    count = np.diff(np.append(edges, whole[0].size))
    one, record = (np.add.reduceat(limit, edges) / count for limit in whole[1:])
    return whole[0][chosen], one, record


def _longest(axis: Axis, time: Floats, constituents: Constituents) -> tuple[slice, Floats]:
    """Return the longest part without gaps, and its series without constituents."""
    series = adjust(time, axis.values, constituents, interval=axis.clock.interval).residual
    part = longest_part(axis.clock.breaks, series.size)
    return part, np.ascontiguousarray(series[part])


def _without_lines(series: Floats, time: Floats, lines: Sequence[PeakResult]) -> Floats:
    """Return a series without its steady lines, which are no noise.

    Args:
        series: (n,).
        time: (n,) s from the axis's first sample on.
        lines: those found.
    """
    for line in lines:
        if line.phase is not None:
            series = series - line.amplitude * np.cos(2 * np.pi * line.frequency * time + line.phase)
    return series


def _lines(series: Floats, dt: float, found: Extraction, parameters: Parameters, highest: float) -> list[PeakResult]:
    """Return steady and drifting lines, the largest first."""
    drifting, steady = drifting_lines(series, dt, found.peaks, parameters.level, parameters.confidence)
    spread = float(np.var(series))
    lines = [
        PeakResult(
            peak.frequency, *peak.frequency_interval, peak.amplitude, peak.lower, peak.upper, peak.phase, *peak.phase_interval,
            peak.percent, peak.probability, peak.significant, peak.in_both_halves, True, "",
        )
        for peak in steady
    ]  # fmt: skip
    lines += [
        PeakResult(
            line.frequency, line.frequency - line.resolution, line.frequency + line.resolution, line.amplitude, line.lower,
            line.upper, None, None, None, 50 * line.amplitude**2 / spread, None, True, line.in_both_halves, False, "",
        )
        for line in drifting if line.frequency <= highest
    ]  # fmt: skip
    return sorted(lines, key=lambda line: -line.amplitude)[: parameters.peaks]


def _named(lines: Sequence[PeakResult]) -> tuple[PeakResult, ...]:
    """Return lines with names: as a harmonic where one is of a larger line."""
    found: list[PeakResult] = []
    for k, line in enumerate(lines):
        name = f"{line.frequency:.4g} Hz"
        for base in lines[:k]:
            ratio = line.frequency / base.frequency
            if round(ratio) >= 2 and abs(ratio - round(ratio)) < HARMONIC * ratio:  # noqa: PLR2004 - a harmonic
                name = f"{round(ratio)} × {base.frequency:.4g} Hz"
                break
        found.append(replace(line, name=name))
    return tuple(found)


def _constituents(spectrum: Spectrum, confidence: float) -> tuple[ConstituentResult, ...]:
    """Return the constituents; where the noise has no structure, its slowest frequencies are what disturbs them."""
    adjusted = spectrum.adjusted
    factor = normal_limit(confidence)
    if adjusted.noise.noise.kind == "local":
        slow = spectrum.reduction[spectrum.oversampling - 1 : SLOW * spectrum.oversampling : spectrum.oversampling]
        more = float(slow.mean()) / (2 * adjusted.rest / adjusted.freedom)
        factor = student_limit(confidence, 2 * slow.size) * np.sqrt(max(more, 1.0))
    rows: list[ConstituentResult] = []
    for name, value, sigma in zip(adjusted.names, adjusted.coefficients, adjusted.sigma, strict=True):
        # a trend goes from -1 to 1 over the record
        times, said = (2.0, "trend over the record") if name == "trend" else (1.0, name)
        middle, half = times * float(value), times * factor * float(sigma)
        rows.append(ConstituentResult(said, middle, middle - half, middle + half))
    return tuple(rows)


def _hypotheses(series: Floats, parameters: Parameters) -> tuple[HypothesisResult, ...]:
    """Return tests of a series without gaps."""
    try:
        tests = (
            is_random_walk(series, parameters.level),
            is_autoregressive(series, parameters.order, parameters.level),
        )
    except ValueError:
        return ()
    return tuple(_hypothesis(test, parameters) for test in tests)


def _hypothesis(test: Hypothesis, parameters: Parameters) -> HypothesisResult:
    return HypothesisResult(
        test.name, test.tenable, test.p_value, test.correlations, test.octaves, tuple(float(a) for a in test.alpha),
        tuple(float(s) for s in test.sigma), float(test.octave_power[0]), words(test, parameters.level, parameters.confidence),
    )  # fmt: skip


def _band_notes(results: dict[str, AxisResult], parameters: Parameters) -> list[str]:
    said: dict[str, str] = {}
    for name, r in results.items():
        sensor = name.partition("_")[0]
        if r.why_none is None and sensor not in said:
            also = f"; a line at f shows at {r.mirror:.5g} Hz - f as well" if r.mirror is not None else ""
            said[sensor] = (
                f"{sensor}: the spacing of its samples tells lines of {r.lowest:.3g} to {r.highest:.5g} Hz apart{also}"
            )
            if parameters.highest is not None and parameters.highest > r.highest * (1 + 1e-9):
                said[sensor] += f"; nothing is looked for from there to the {parameters.highest:g} Hz of --highest"
    return list(said.values())


def findings(result: Result) -> tuple[Finding, ...]:
    """Return the lines that both halves show."""
    found: list[Finding] = []
    for axis, r in result.axes.items():
        lines = [p for p in r.peaks if p.significant and p.in_both_halves]
        remark = f"line{'s' if len(lines) > 1 else ''} at {', '.join(p.name for p in lines[:3])}" if lines else ""
        found.append(Finding(axis, "lssa", {}, (remark,) if remark else ()))
    return tuple(found)

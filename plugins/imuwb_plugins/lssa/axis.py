"""The least-squares spectrum of one axis, with its lines, constituents and tests of the noise."""

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.axes import Axis
from imuwb.identification import power_spectrum
from imuwb.identification.lssa import (
    Constituents,
    Extraction,
    Hypothesis,
    Noise,
    Significance,
    Spectrum,
    adjust,
    extract,
    is_autoregressive,
    is_random_walk,
    least_squares_spectrum,
    usable_band,
)
from imuwb.identification.record.suitable import unsuitable
from imuwb.log import SECOND
from imuwb.sampling import longest_part
from imuwb.statistics import Estimate
from imuwb.statistics.distributions import normal_limit, student_limit
from imuwb_plugins.lssa.lines import lines_of, without_lines
from imuwb_plugins.lssa.parameters import Parameters
from imuwb_plugins.lssa.result import LssaAxis

FEWEST = 256  #: samples
BINS = 1500  #: bins of frequency in the figures, equally wide on a logarithmic axis
SLOW = 8  #: number of the lowest Fourier frequencies, whose noise disturbs a level or a trend
LARGEST_SHARE = 0.999  #: largest share of a limit in decibels; a share of 1 would be infinite
NONE = np.empty(0)


def axis_result(
    axis: Axis, parameters: Parameters, constituents: Constituents, noise: Noise, zero: int, band: float
) -> LssaAxis:
    """Return the spectrum of one axis, or why it has none.

    Args:
        axis: with or without gaps.
        parameters: options.
        constituents: known constituents, in the log's time.
        noise: structure of the noise.
        zero: ns, of the log's time.
        band: Hz, up to which no filter has changed the samples.
    """
    why = unsuitable(axis.values, FEWEST)
    if why is not None:
        return _without_spectrum(why)
    time = (axis.time - zero) / SECOND
    try:
        adjusted = adjust(time, axis.values, constituents, noise, interval=axis.clock.interval)
        usable = usable_band(adjusted)
        highest = min(x for x in (parameters.highest, band, usable.highest) if x is not None)
        spectrum = least_squares_spectrum(adjusted, highest=highest, oversampling=parameters.oversampling)
        part, series = _longest_part(axis, time, constituents)
    except ValueError as error:
        return _without_spectrum(str(error))
    extraction = extract(spectrum, parameters.level, parameters.confidence, parameters.peaks)
    shown = _highest_of_bins(extraction)
    critical: tuple[float | None, float | None] = (None, None)
    if noise.kind != "local":
        one, record = extraction.significance.share_limit(adjusted.freedom)
        critical = 100 * one, 100 * record
    lines = lines_of(series, axis.clock.interval, extraction.peaks, parameters, highest)
    noise_alone = without_lines(series, adjusted.time[part], lines)
    return LssaAxis(
        spectrum.frequency[shown], spectrum.percent[shown], spectrum.density[shown],
        *_scaled(spectrum, extraction.left_significance, parameters.scale, shown), *_fourier(axis), *critical, lines,
        _constituents(spectrum, parameters.confidence, axis.sensor), _hypotheses(noise_alone, parameters),
        tuple(float(a) for a in adjusted.noise.alpha), adjusted.noise.correlation_time, spectrum.frequency.size, usable.lowest,
        usable.highest, highest, usable.mirror, None,
    )  # fmt: skip


def _without_spectrum(why: str) -> LssaAxis:
    return LssaAxis(
        NONE, NONE, NONE, NONE, NONE, NONE, NONE, NONE, None, None, (), {}, (), (), None, 0, 0.0, 0.0, 0.0, None, why
    )


def _longest_part(axis: Axis, time: Floats, constituents: Constituents) -> tuple[slice, Floats]:
    """Return the longest part without gaps, and its series without constituents."""
    series = adjust(time, axis.values, constituents, interval=axis.clock.interval).residual
    part = longest_part(axis.clock.breaks, series.size)
    return part, np.ascontiguousarray(series[part])


def _fourier(axis: Axis) -> tuple[Floats, Floats]:
    """Return Welch's spectrum of the longest part without gaps, if that is long enough."""
    if unsuitable(axis.longest, FEWEST) is not None:
        return NONE, NONE
    spectrum = power_spectrum(axis.longest, axis.clock.interval)
    return spectrum.frequency, spectrum.density


def _highest_of_bins(extraction: Extraction) -> Integers:
    """Return the index of the highest exceedance in each bin of frequencies."""
    frequency, exceedance = extraction.spectrum.frequency, extraction.significance.exceedance
    edges = np.geomspace(frequency[0], frequency[-1], BINS + 1)
    starts = np.unique(np.searchsorted(frequency, edges[:-1]))
    ends = np.append(starts[1:], frequency.size)
    return np.array([a + int(np.argmax(exceedance[a:b])) for a, b in zip(starts, ends, strict=True)])


def _scaled(
    spectrum: Spectrum, significance: Significance, scale: str, shown: Integers
) -> tuple[Floats, Floats, Floats]:
    """Return the thinned spectrum and both limits in a scale; a limit is the mean over the frequencies of its bin."""
    if scale == "density":
        values = spectrum.density
        limits = [significance.limit(spectrum, x) for x in (significance.one, significance.record)]
    else:
        rest = spectrum.adjusted.rest
        shares = [significance.reduction(spectrum, x) / rest for x in (significance.one, significance.record)]
        if scale == "percent":
            values, limits = spectrum.percent, [100 * s for s in shares]
        elif scale == "decibels":
            ratios = [np.clip(s / (1 - np.minimum(s, LARGEST_SHARE)), 1e-30, None) for s in shares]
            values, limits = spectrum.decibels, [10 * np.log10(ratio) for ratio in ratios]
        else:
            values, limits = spectrum.printed_density, [s * rest / spectrum.frequency for s in shares]
    edges = np.concatenate([[0], (shown[1:] + shown[:-1] + 1) // 2])
    count = np.diff(np.append(edges, values.size))
    one, record = (np.add.reduceat(limit, edges) / count for limit in limits)
    return values[shown], one, record


def _constituents(spectrum: Spectrum, confidence: float, sensor: str) -> dict[str, Estimate]:
    """Return the constituents by name; with local noise their errors come from the noise at the lowest frequencies."""
    adjusted = spectrum.adjusted
    factor = normal_limit(confidence)
    if adjusted.noise.noise.kind == "local":
        slow = spectrum.reduction[spectrum.oversampling - 1 : SLOW * spectrum.oversampling : spectrum.oversampling]
        excess = float(slow.mean()) / (2 * adjusted.rest / adjusted.freedom)
        factor = student_limit(confidence, 2 * slow.size) * np.sqrt(max(excess, 1.0))
    estimates: dict[str, Estimate] = {}
    for name, value, sigma in zip(adjusted.names, adjusted.coefficients, adjusted.sigma, strict=True):
        # the column of the trend goes from -1 to 1
        times, full_name = (2.0, "trend over the record") if name == "trend" else (1.0, name)
        middle, half = times * float(value), times * factor * float(sigma)
        unit = "rad/s" if sensor == "gyro" else "m/s²"
        estimates[full_name] = Estimate(middle, middle - half, middle + half, unit=unit)
    return estimates


def _hypotheses(series: Floats, parameters: Parameters) -> tuple[Hypothesis, ...]:
    """Return tests of a series without gaps; none if it is too short."""
    try:
        return (
            is_random_walk(series, parameters.level),
            is_autoregressive(series, parameters.order, parameters.level, parameters.confidence),
        )
    except ValueError:
        return ()

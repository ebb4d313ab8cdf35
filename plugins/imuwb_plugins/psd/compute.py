"""From a log to densities and fitted sums."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from imuwb.analysis import Finding
from imuwb.arrays import Floats
from imuwb.axes import Axis, axes_of, for_each, gap_notes, rates
from imuwb.identification import Line, PowerSpectrum, SpectralFit, find_lines, fit_spectrum, power_spectrum
from imuwb.identification.record.suitable import unsuitable
from imuwb.log import Log
from imuwb.noise_results import ModelCurves, line_name, line_result, missing_notes
from imuwb.notes import Note
from imuwb.statistics import UNKNOWN
from imuwb.units import coefficient_units
from imuwb_plugins.psd.parameters import Parameters
from imuwb_plugins.psd.result import Result, SpectrumAxis

FEWEST = 256  #: samples
PEAK = 2.0  #: ratio to the fitted density, above which a broad peak is called a resonance
APART = 0.1  #: difference of natural logarithms; a spectrum that differs by more leaves its white level
BEYOND_CHANCE = 4.0  #: standard errors by which it must differ as well
POINTS = 200  #: frequencies of the model's densities in the figure
FIRST = 3  #: lowest bins, in which the window spreads the drift
COLUMNS = 1500  #: of the figure before frequency averaging
NAMED = 3  #: lines that a remark names, the strongest


def run(logs: Sequence[Log], parameters: Parameters) -> Result:
    """Return the spectra of the log's (first) IMU.

    Raises:
        MissingDataError: no axis has a spectrum.
    """
    log = logs[0]
    imu = log.imu()
    axes = axes_of(imu)
    results = for_each(axes, lambda axis: _axis(axis, parameters, log.band))
    missing = missing_notes(log, {name: r.why_none for name, r in results.items()}, "no-spectrum", "a spectrum")
    sizes = {axis.sensor: min(parameters.segment, axis.values[axis.longest_rows].size) for axis in axes.values()}
    notes = (*gap_notes(axes, "the spectrum"), *missing)
    return Result(imu.name, parameters.level, rates(axes), sizes, results, notes)


def _axis(axis: Axis, parameters: Parameters, band: float) -> SpectrumAxis:
    series, dt, name = axis.values[axis.longest_rows], axis.clock.interval, axis.name
    why = unsuitable(series, FEWEST)
    unknown = {x: UNKNOWN.in_unit(coefficient_units(name, x)[0].name) for x in "QNBK"}
    if why is not None:
        none = np.empty(0)
        return SpectrumAxis(none, none, none, none, 1, unknown, why_none=why)
    spectrum = power_spectrum(series, dt, parameters.segment, level=parameters.level)
    lines = find_lines(series, dt, parameters.level) if parameters.lines else ()
    lines = tuple(line for line in lines if line.frequency <= band)
    lasting = [line for line in lines if line.in_both_halves]
    result = SpectrumAxis(
        spectrum.frequency, spectrum.density, spectrum.lower, spectrum.upper, spectrum.sides, unknown,
        lines=tuple(line_result(name, x, _line_name(x, lasting)) for x in lasting),
        raw=_extremes(spectrum) if parameters.raw else None,
    )  # fmt: skip
    try:
        fit = fit_spectrum(spectrum, lines, band)
    except ValueError as error:
        return replace(result, why_none=f"no fit: {error}")
    # Of a filtered log, the spectrum would show the filter.
    white_to, excess = _white_to(spectrum, fit) if band >= 0.5 / dt else (None, 1.0)
    return replace(
        result,
        coefficients={x: replace(c, unit=unknown[x].unit, at=None) for x, c in fit.coefficients.items()},
        regions=fit.regions, processes=fit.processes, white_to=white_to, excess=excess, explained_to=fit.highest,
        probability=fit.probability, resonances=_resonances(spectrum, fit, lines),
        model_densities=_model_densities(fit, float(spectrum.frequency[0]), dt),
    )  # fmt: skip


def _extremes(spectrum: PowerSpectrum) -> Floats:
    """Return the smallest and the largest density in narrow columns of frequency: on a screen they look like all of them."""
    f, density = spectrum.raw_frequency[FIRST:], spectrum.raw[FIRST:]
    edges = np.unique(np.searchsorted(f, np.geomspace(f[0], f[-1], COLUMNS)))
    ends = [
        begin + int(which(density[begin:end]))
        for begin, end in pairwise((*edges.tolist(), density.size))
        if end > begin
        for which in (np.argmin, np.argmax)
    ]
    rows = np.unique(ends)
    return np.stack([f[rows], density[rows]])


def _line_name(line: Line, lines: Sequence[Line]) -> str:
    name = line_name(line.frequency, (x.frequency for x in lines if x.amplitude.value > line.amplitude.value))
    return name if "×" in name else f"line at {name}"


def _white_to(spectrum: PowerSpectrum, fit: SpectralFit) -> tuple[float | None, float]:
    """Return the frequency above the fitted band from which the spectrum leaves the fit, or None, and their ratio above it."""
    if fit.coefficients["N"].value is None:
        return None, 1.0
    ratio = spectrum.density / fit.density(spectrum.frequency, spectrum.dt)
    off = (np.abs(np.log(ratio)) > APART) & (
        np.abs(ratio - 1) > BEYOND_CHANCE * np.sqrt(2 / spectrum.degrees_of_freedom)
    )
    beyond = spectrum.frequency > fit.highest
    if not (off & beyond).any():
        return None, 1.0
    first = int(np.argmax(off & beyond))
    return float(spectrum.frequency[first]), float(np.exp(np.mean(np.log(ratio[first:]))))


def _resonances(spectrum: PowerSpectrum, fit: SpectralFit, lines: Sequence[Line]) -> tuple[float, ...]:
    """Return the frequencies (Hz) of broad peaks above the fitted band that are no lines."""
    beyond = spectrum.frequency > fit.highest
    ratio = np.where(beyond, spectrum.density / fit.density(spectrum.frequency.clip(max=fit.highest), spectrum.dt), 0.0)
    for line in lines:
        ratio[np.abs(np.log(spectrum.frequency / line.frequency)) < APART] = 0.0
    inside = np.flatnonzero(ratio > PEAK)
    runs = np.split(inside, np.flatnonzero(np.diff(inside) > 1) + 1)
    return tuple(float(spectrum.frequency[run[int(np.argmax(ratio[run]))]]) for run in runs if run.size)


def _model_densities(fit: SpectralFit, begin: float, dt: float) -> ModelCurves:
    f = np.geomspace(begin, fit.highest, POINTS)
    terms = tuple(2 * term.power_spectral_density(f, dt) for term in fit.processes.terms)
    return ModelCurves(f, fit.density(f, dt), terms)


def findings(result: Result) -> tuple[Finding, ...]:
    """Return the coefficients of each axis, with remarks on what is not white noise."""
    return tuple(Finding(axis, "psd", r.coefficients, tuple(_remarks(r))) for axis, r in result.axes.items())


def _remarks(r: SpectrumAxis) -> Iterator[Note]:
    if r.white_to is not None:
        how = "falls below" if r.excess < 1 else "rises above"
        ratio = f"{abs(10 * np.log10(r.excess)):.1f} dB"
        yield Note("not-white", f"not white above {r.white_to:.3g} Hz: the spectrum {how} its white level by {ratio}")
    if r.resonances:
        yield Note("resonance", f"resonance near {', '.join(f'{f:.3g}' for f in r.resonances)} Hz")
    if r.lines:
        names = ", ".join(line.name.removeprefix("line at ") for line in r.lines[:NAMED])
        more = f" and {len(r.lines) - NAMED} more" if len(r.lines) > NAMED else ""
        yield Note("lines", f"line{'s' if len(r.lines) > 1 else ''} at {names}{more}")

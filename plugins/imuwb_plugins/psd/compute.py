"""From a log to densities and fitted sums."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from imuwb.analysis import Finding, LineResult
from imuwb.axes import axes_of, for_each, gap_notes, rates
from imuwb.errors import MissingDataError
from imuwb.identification import find_lines, fit_spectrum, power_spectrum
from imuwb.identification.record.suitable import unsuitable
from imuwb.statistics import UNKNOWN
from imuwb.units import coefficient_units
from imuwb_plugins.psd.result import AxisResult, Result

if TYPE_CHECKING:
    from collections.abc import Sequence

    from imuwb.axes import Axis
    from imuwb.identification import Line, PowerSpectrum, SpectralFit
    from imuwb.log import Log
    from imuwb_plugins.psd.parameters import Parameters

FEWEST = 256  #: samples
HARMONIC = 0.01  #: of a multiple, by which a harmonic may miss it
PEAK = 2.0  #: times the fitted density; a broad peak so high is called a resonance
APART = 0.1  #: of the white level, by which the spectrum must leave it
BEYOND_CHANCE = 4.0  #: standard errors, likewise


def run(logs: Sequence[Log], parameters: Parameters) -> Result:
    """Return the spectra of the log's (first) IMU."""
    log = logs[0]
    imu = log.imu()
    axes = axes_of(imu)
    results = for_each(axes, lambda axis: _axis(axis, parameters, log.band))
    if all(r.why_none for r in results.values()):
        message = f"{log.provenance.path}: {imu.name}: no axis has a spectrum: {next(iter(results.values())).why_none}"
        raise MissingDataError(message)
    notes = [*gap_notes(axes, "the spectrum"), *(f"{name}: {r.why_none}" for name, r in results.items() if r.why_none)]
    sizes = {axis.sensor: min(parameters.segment, axis.longest.size) for axis in axes.values()}
    return Result(imu.name, parameters.level, rates(axes), sizes, results, tuple(notes))


def _axis(axis: Axis, parameters: Parameters, band: float) -> AxisResult:
    series, dt, name = axis.longest, axis.clock.interval, axis.name
    why = unsuitable(series, FEWEST)
    none = np.empty(0)
    unknown = {x: UNKNOWN.in_unit(coefficient_units(name, x)[0].name) for x in "QNBK"}
    if why is not None:
        return AxisResult(none, none, none, none, 1, unknown, (), (), None, None, 1.0, None, None, why)
    spectrum = power_spectrum(series, dt, parameters.segment, level=parameters.level)
    lines = (
        tuple(x for x in find_lines(series, dt, parameters.level) if x.frequency <= band) if parameters.lines else ()
    )
    named = tuple(_named(name, line, lines) for line in lines)
    try:
        fit = fit_spectrum(spectrum, lines, band)
    except ValueError as error:
        return AxisResult(
            spectrum.frequency, spectrum.density, spectrum.lower, spectrum.upper, spectrum.sides, unknown, (), named, None, None, 1.0,
            None, None, f"no fit: {error}",
        )  # fmt: skip
    found = {x: replace(c, unit=unknown[x].unit, at=None) for x, c in fit.coefficients.items()}
    white_to, excess = _white_to(spectrum, fit) if band >= 0.5 / dt else (None, 1.0)  # else the filter is what it sees
    resonances = _resonances(spectrum, fit, lines)
    return AxisResult(
        spectrum.frequency, spectrum.density, spectrum.lower, spectrum.upper, spectrum.sides, found, fit.regions, named,
        fit.processes, white_to, excess, fit.highest, fit.probability, None, resonances,
    )  # fmt: skip


def _named(axis: str, line: Line, lines: Sequence[Line]) -> LineResult:
    """Name a line, as a harmonic where it is one of a stronger line."""
    unit = coefficient_units(axis, "rate")[0].name
    name = f"line at {line.frequency:.4g} Hz"
    for base in lines:
        ratio = line.frequency / base.frequency
        if base.amplitude > line.amplitude and round(ratio) >= 2 and abs(ratio - round(ratio)) < HARMONIC * ratio:  # noqa: PLR2004 - a harmonic
            name = f"{round(ratio)} × {base.frequency:.4g} Hz"
            break
    return LineResult(line.frequency, line.amplitude, line.lower, line.upper, unit, name)


def _white_to(spectrum: PowerSpectrum, fit: SpectralFit) -> tuple[float | None, float]:
    """Return where, above the fitted band, the spectrum first leaves the fit, and by what factor it is off from there on; None: nowhere."""
    white = fit.coefficients["N"].value
    if white is None:
        return None, 1.0
    expected = fit.density(spectrum.frequency, spectrum.dt)
    ratio = spectrum.density / expected
    off = (np.abs(np.log(ratio)) > APART) & (
        np.abs(ratio - 1) > BEYOND_CHANCE * np.sqrt(2 / spectrum.degrees_of_freedom)
    )
    beyond = spectrum.frequency > fit.highest
    if not (off & beyond).any():
        return None, 1.0
    first = int(np.argmax(off & beyond))
    return float(spectrum.frequency[first]), float(np.exp(np.mean(np.log(ratio[first:]))))


def _resonances(spectrum: PowerSpectrum, fit: SpectralFit, lines: Sequence[Line]) -> tuple[float, ...]:
    """Return the frequencies of broad peaks above the fitted band, Hz: twice the fitted density, and no line's."""
    beyond = spectrum.frequency > fit.highest
    ratio = np.where(beyond, spectrum.density / fit.density(spectrum.frequency.clip(max=fit.highest), spectrum.dt), 0.0)
    for line in lines:
        ratio[np.abs(np.log(spectrum.frequency / line.frequency)) < APART] = 0.0
    inside = np.flatnonzero(ratio > PEAK)
    peaks = [
        run[int(np.argmax(ratio[run]))] for run in np.split(inside, np.flatnonzero(np.diff(inside) > 1) + 1) if run.size
    ]
    return tuple(float(spectrum.frequency[k]) for k in peaks)


def findings(result: Result) -> tuple[Finding, ...]:
    """Return the coefficients, and what is not white or not noise."""
    return tuple(
        Finding(axis, "psd", found.coefficients, tuple(_remarks(found))) for axis, found in result.axes.items()
    )


def _remarks(found: AxisResult) -> list[str]:
    said: list[str] = []
    if found.white_to is not None:
        how = "falls below" if found.excess < 1 else "rises above"
        said.append(
            f"not white above {found.white_to:.3g} Hz: the spectrum {how} its white level by {abs(10 * np.log10(found.excess)):.1f} dB"
        )
    if found.resonances:
        said.append(f"resonance near {', '.join(f'{f:.3g}' for f in found.resonances)} Hz")
    strongest = found.lines[:3]
    if strongest:
        names = ", ".join(line.name.removeprefix("line at ") for line in strongest)
        more = f" and {len(found.lines) - 3} more" if len(found.lines) > 3 else ""  # noqa: PLR2004 - those not named
        said.append(f"line{'s' if len(found.lines) > 1 else ''} at {names}{more}")
    return said

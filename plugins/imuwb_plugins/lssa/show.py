"""Figures and tables of least-squares spectra."""

import numpy as np

from imuwb.analysis import Curve, Figure, Mark, Review, Table
from imuwb.colors import AXIS_COLORS, GREY, ORANGE
from imuwb.identification.lssa import ChiSquare
from imuwb.noise_results import SENSORS, by_sensor
from imuwb.texts import converted_text, decimals
from imuwb.units import UNITS, coefficient_units
from imuwb_plugins.lssa.result import LssaAxis, PeakResult, Result

DENSITY_UNITS = {"gyro": UNITS["deg/s"], "accel": UNITS["m/s²"]}
NOTHING_DB = -150.0  #: dB; smaller values are not drawn
LABELLED = 5  #: lines with a label in a figure, at most
RARE = 1e-6  #: smaller probabilities are not printed


def draw(result: Result, review: Review) -> None:
    """Show lines and tests, then the spectra of each sensor on a tab."""
    for note in result.notes:
        review.note(note)
    review.table(_peaks(result))
    review.table(_hypotheses(result))
    if any(r.constituents for r in result.axes.values()):
        review.table(_constituents(result))
    for sensor, axes in by_sensor({a: r for a, r in result.axes.items() if r.why_none is None}).items():
        review.tab(f"Lssa: {SENSORS[sensor].lower()}")
        for axis in axes:
            review.figure(figure(axis, result))


def figure(axis: str, result: Result) -> Figure:
    """Return the spectrum of an axis, its levels, and its lines."""
    spectrum = result.axes[axis]
    rate = DENSITY_UNITS[axis.partition("_")[0]]
    scale, y_title = {
        "density": (rate.factor**2, f"one-sided density [({rate.name})²/Hz]"),
        "percent": (1.0, "share of the residual [%]"),
        "decibels": (1.0, "signal-to-noise ratio, eq. 12 as printed [dB]"),
        "printed": (1.0, "quadratic form over f, eq. 13 as printed [1/Hz]"),
    }[result.scale]
    level = f"{100 * result.level:g} %"
    nothing = NOTHING_DB if result.scale == "decibels" else 0.0
    curves = [
        Curve(name, spectrum.frequency[values > nothing], values[values > nothing] / scale, color, style=style)
        for name, values, color, style in (
            (f"{axis.replace('_', ' ')}, highest in each bin", spectrum.shown, AXIS_COLORS[axis[-1]], "curve"),
            (f"{level}, one frequency", spectrum.shown_limit, GREY, "fit"),
            (f"{level}, whole record", spectrum.shown_record_limit, ORANGE, "fit"),
        )
    ]
    if result.scale == "density":
        curves.append(
            Curve("Fourier (Welch)", spectrum.fourier_frequency, spectrum.fourier_density / scale, GREY, style="faint")
        )
    marks = tuple(
        Mark(peak.frequency.value, _height(spectrum, peak) / scale, peak.name, ORANGE, _amplitude(axis, peak))
        for peak in [p for p in spectrum.peaks if p.claimed][:LABELLED]
    )
    return Figure(
        f"{axis.replace('_', ' ')}: least-squares spectrum", "frequency [Hz]", y_title, tuple(curves), marks,
        y_scale="linear" if result.scale == "decibels" else "log",
    )  # fmt: skip


def _amplitude(axis: str, peak: PeakResult) -> str:
    unit = coefficient_units(axis, "rate")[1]
    return f"{unit.from_si(peak.amplitude.value):.3g} {unit.name}"


def _height(spectrum: LssaAxis, peak: PeakResult) -> float:
    return float(spectrum.shown[int(np.argmin(np.abs(spectrum.frequency - peak.frequency.value)))])


def _peaks(result: Result) -> Table:
    rows = tuple(
        (
            axis, peak.name, _frequency(peak), converted_text(peak.amplitude, coefficient_units(axis, "rate")[1]), _phase(peak), f"{peak.percent:.3g} %", _chance(peak, result),
            _verdict(peak),
        )
        for axis, spectrum in result.axes.items()
        for peak in spectrum.peaks
    )  # fmt: skip
    headings = (
        "axis", "line", "frequency", "amplitude", "phase at start", "share of residual", "probability by chance", "verdict",
    )  # fmt: skip
    rows = rows or ((*("—",) * (len(headings) - 1), f"no line at {100 * result.level:g} %"),)
    caption = (
        f"Intervals at {100 * result.confidence:g} %. Probability by chance: probability that noise alone makes so strong a line "
        "anywhere in the record. A line is claimed if each half of the record shows it by itself. A drifting line is found in averaged spectra of segments."
    )
    return Table(f"Lines of {result.imu}; noise: {result.noise}", headings, rows, caption)


def _frequency(peak: PeakResult) -> str:
    frequency, half = peak.frequency.value, peak.frequency.upper - peak.frequency.value
    return f"{frequency:.7g} ± {half:.1g} Hz" if peak.steady else f"{frequency:.4g} Hz, drifting ({half:.1g} Hz)"


def _phase(peak: PeakResult) -> str:
    if peak.phase is None:
        return "—"
    return f"{np.degrees(peak.phase.value):.0f} ± {np.degrees(peak.phase.upper - peak.phase.value):.0f} deg"


def _chance(peak: PeakResult, result: Result) -> str:
    return f"< {1 - result.level:.2g}" if peak.probability is None else _probability(peak.probability)


def _probability(value: float) -> str:
    return "< 1e-6" if value < RARE else f"{value:.2g}"


def _verdict(peak: PeakResult) -> str:
    if not peak.significant:
        return "not significant next to the other lines"
    return "line" if peak.in_both_halves else "not in both halves: no line is claimed"


def _hypotheses(result: Result) -> Table:
    rows = tuple(
        (axis, f"H0: {test.name}", test.verdict, _statistic(test.correlations), _statistic(test.octaves), f"{test.octave_power[0]:.3g} times")
        for axis, spectrum in result.axes.items()
        for test in spectrum.hypotheses
    )  # fmt: skip
    caption = (
        f"Tests at {100 * result.level:g} %. C is the coefficient in b(k+1) = C b(k) + e (El-Diasty), the negative of alpha in "
        "x(n) = -alpha x(n-1) + w(n). The tests use the longest part without gaps, without steady lines, and whitened: the "
        "correlations of short lags (Ljung and Box), and the powers in octaves for slow drifts (Bartlett)."
    )
    octave = "power of the lowest octave over the mean"
    headings = ("axis", "hypothesis", "verdict", "short lags", "slow drifts", octave)
    return Table("Structure of the noise", headings, rows, caption)


def _statistic(test: ChiSquare) -> str:
    return f"{test.value:.4g}, chi-square({test.freedom}), p {_probability(test.probability)}"


def _constituents(result: Result) -> Table:
    rows: list[tuple[str, ...]] = []
    for axis, spectrum in result.axes.items():
        unit = coefficient_units(axis, "rate")[1]
        for name, estimate in spectrum.constituents.items():
            value, half = unit.from_si(estimate.value), unit.from_si(estimate.upper - estimate.value)
            rows.append((axis, name, f"{value:.{decimals(half)}f} ± {half:.{decimals(half)}f} {unit.name}"))
    return Table(
        "Constituents, estimated together with the lines", ("axis", "constituent", "size"), tuple(rows),
        f"Intervals at {100 * result.confidence:g} % assume the noise of --noise; with local noise, the noise at the lowest frequencies.",
    )  # fmt: skip

"""Figures and tables of least-squares spectra. Nothing is computed here but units."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from imuwb.analysis import Curve, Figure, Mark, Table
from imuwb.colors import AXIS_COLORS
from imuwb.units import coefficient_units

if TYPE_CHECKING:
    from imuwb.analysis import Review
    from imuwb.identification.lssa import ChiSquare
    from imuwb_plugins.lssa.result import AxisResult, PeakResult, Result

_UNITS = {"gyro": ("deg/s", np.pi / 180), "accel": ("m/s²", 1.0)}
_SENSORS = {"gyro": "gyroscopes", "accel": "accelerometers"}
NOTHING_DB = -150.0  #: dB, below which a spectrum says nothing
LABELLED = 5  #: lines whose frequency stands beside them
ONE_COLOR, RECORD_COLOR, FOURIER_COLOR = (150, 150, 155), (230, 159, 0), (120, 120, 125)


def draw(result: Result, review: Review) -> None:
    """Show lines and tests, then the spectra of each sensor on a tab."""
    for note in result.notes:
        review.note(note)
    review.table(_peaks(result))
    review.table(_hypotheses(result))
    if any(r.constituents for r in result.axes.values()):
        review.table(_constituents(result))
    for sensor, title in _SENSORS.items():
        axes = {a: r for a, r in result.axes.items() if a.startswith(sensor) and r.why_none is None}
        if axes:
            review.tab(f"Lssa: {title}")
            for axis, found in axes.items():
                review.figure(_figure(axis, found, result))


def _figure(axis: str, found: AxisResult, result: Result) -> Figure:
    sensor = axis.partition("_")[0]
    unit, factor = _UNITS[sensor]
    scale, y_title = {
        "density": (factor**2, f"one-sided density [({unit})²/Hz]"),
        "percent": (1.0, "share of the residual [%]"),
        "decibels": (1.0, "signal to noise, eq. 12 as printed [dB]"),
        "printed": (1.0, "quadratic form over f, eq. 13 as printed [1/Hz]"),
    }[result.scale]
    level = f"{100 * result.level:g} %"
    nothing = NOTHING_DB if result.scale == "decibels" else 0.0
    curves = [
        Curve(name, found.frequency[values > nothing], values[values > nothing] / scale, color, style="curve")
        for name, values, color in (
            (f"{axis.replace('_', ' ')}, highest in each bin", found.shown, AXIS_COLORS[axis[-1]]),
            (f"{level}, one frequency", found.shown_one, ONE_COLOR),
            (f"{level}, whole record", found.shown_record, RECORD_COLOR),
        )
    ]
    if result.scale == "density":
        curves.append(
            Curve(
                "Fourier (Welch)", found.fourier_frequency, found.fourier_density / scale, FOURIER_COLOR, style="faint"
            )
        )
    marks = tuple(
        Mark(peak.frequency, _height(found, peak) / scale, peak.name, RECORD_COLOR)
        for peak in [p for p in found.peaks if p.significant and p.in_both_halves][:LABELLED]
    )
    return Figure(
        f"{axis.replace('_', ' ')}: least-squares spectrum", "frequency [Hz]", y_title, tuple(curves), marks,
        y_scale="linear" if result.scale == "decibels" else "log",
    )  # fmt: skip


def _height(found: AxisResult, peak: PeakResult) -> float:
    return float(found.shown[int(np.argmin(np.abs(found.frequency - peak.frequency)))])


def _peaks(result: Result) -> Table:
    rows = tuple(
        (
            axis, peak.name, _frequency(peak), _amplitude(axis, peak), _phase(peak), f"{peak.percent:.3g} %", _chance(peak, result),
            _verdict(peak),
        )
        for axis, found in result.axes.items()
        for peak in found.peaks
    )  # fmt: skip
    headings = ("axis", "line", "frequency", "amplitude", "phase at start", "takes up", "by chance", "verdict")
    rows = rows or ((*("—",) * (len(headings) - 1), f"no line at {100 * result.level:g} %"),)
    caption = (
        f"Intervals at {100 * result.confidence:g} %. By chance: how often noise alone shows as much anywhere in a record. A line is "
        "claimed where each half of the record shows it by itself. One that drifts is told from the floor around it in spectra of segments."
    )
    return Table(f"Lines of {result.imu}, noise: {result.noise}", headings, rows, caption, wide=True)


def _frequency(peak: PeakResult) -> str:
    half = peak.frequency_upper - peak.frequency
    return (
        f"{peak.frequency:.7g} ± {half:.1g} Hz" if peak.steady else f"{peak.frequency:.4g} Hz, drifts ({half:.1g} Hz)"
    )


def _phase(peak: PeakResult) -> str:
    if peak.phase is None or peak.phase_upper is None:
        return "—"
    return f"{np.degrees(peak.phase):.0f} ± {np.degrees(peak.phase_upper - peak.phase):.0f} deg"


def _chance(peak: PeakResult, result: Result) -> str:
    if peak.probability is None:
        return f"< {1 - result.level:.2g}"
    return _probability(peak.probability)


def _probability(value: float) -> str:
    return "< 1e-6" if value < 1e-6 else f"{value:.2g}"  # noqa: PLR2004 - as far as it matters


def _amplitude(axis: str, peak: PeakResult) -> str:
    unit = coefficient_units(axis, "rate")[1]
    value, lower, upper = (unit.from_si(x) for x in (peak.amplitude, peak.lower, peak.upper))
    return f"{value:.3g} [{lower:.3g}, {upper:.3g}] {unit.name}"


def _verdict(peak: PeakResult) -> str:
    if not peak.significant:
        return "not significant beside the others"
    return "line" if peak.in_both_halves else "not in both halves: no line claimed"


def _hypotheses(result: Result) -> Table:
    rows = tuple(
        (axis, f"H0: {test.hypothesis}", test.words, _statistic(test.correlations), _statistic(test.octaves), f"{test.lowest_octave:.3g} times")
        for axis, found in result.axes.items()
        for test in found.hypotheses
    )  # fmt: skip
    caption = (
        f"At {100 * result.level:g} %; C is of b(k+1) = C b(k) + e (El-Diasty), the negative of alpha in x(n) = -alpha x(n-1) + w(n). "
        "Tests of whitened samples without steady lines, the longest part without gaps: short lags by Ljung and Box, slow drifts by Bartlett's test of the octaves' powers."
    )
    headings = ("axis", "hypothesis", "what the tests say", "short lags", "slow drifts", "slowest octave has")
    return Table("What the noise is", headings, rows, caption, wide=True)


def _statistic(test: ChiSquare) -> str:
    return f"{test.value:.4g} of chi-square {test.freedom}, p {_probability(test.probability)}"


def _constituents(result: Result) -> Table:
    rows: list[tuple[str, ...]] = []
    for axis, found in result.axes.items():
        unit = coefficient_units(axis, "rate")[1]
        for one in found.constituents:
            value, half = unit.from_si(one.value), unit.from_si(one.upper) - unit.from_si(one.value)
            rows.append((axis, one.name, f"{value:.6g} ± {half:.1g} {unit.name}"))
    return Table(
        "Constituents estimated together with the lines", ("axis", "constituent", "size"), tuple(rows),
        "Intervals take the noise for what --noise says; with local noise for that of the slowest frequencies.",
    )  # fmt: skip

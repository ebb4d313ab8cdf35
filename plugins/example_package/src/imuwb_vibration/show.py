"""What the review shows of the vibration."""

import numpy as np
from imuwb.analysis import Answer, Bar, Bars, Curve, Figure, Review, Step, Table
from imuwb.colors import AXIS_COLORS
from imuwb.statistics import Estimate
from imuwb.texts import duration_text, number_text

from imuwb_vibration.result import Band, Result

UNITS = {"gyro": ("deg/s", 180 / np.pi), "accel": ("m/s²", 1.0)}
STRONG = 0.5  #: share of a band's power above which a line explains it
COLUMNS = 4  #: bands of the panel


def answer(result: Result) -> Answer:
    """Return what a person must know first."""
    count = min(max(len(axis.bands) for axis in result.axes.values()), COLUMNS)
    headings = ("rms", "all bands", *(_heading(result, place) for place in range(count)))
    rows = tuple(
        (
            name,
            _cell(name, axis.rms),
            *(_cell(name, b.rms) for b in axis.bands[:count]),
            *["—"] * (count - len(axis.bands)),
        )
        for name, axis in result.axes.items()
    )
    numbers = {f"rms of {name}": _shown(name, axis.rms) for name, axis in result.axes.items()}
    about = f"{duration_text(result.seconds)} in {next(iter(result.axes.values())).segments} segments"
    return Answer(
        about, headings, rows, tuple(_sentences(result)), (Step("{command} --full", "intervals and lines"),),
        f"intervals of {100 * result.level:g} % in --full", numbers=numbers,
    )  # fmt: skip


def _heading(result: Result, place: int) -> str:
    """Return the name of a band; sensors of different rates have a last band of different width."""
    bands = [axis.bands[place] for axis in result.axes.values() if place < len(axis.bands)]
    names = {_name(band) for band in bands}
    return names.pop() if len(names) == 1 else f"from {bands[0].low:g} Hz"


def _sentences(result: Result) -> list[str]:
    """Return the loudest band of each kind of sensor, and the line that explains it."""
    said: list[str] = []
    for sensor in UNITS:
        axes = {name: axis for name, axis in result.axes.items() if name.startswith(sensor)}
        if not axes:
            continue
        name, band = max(((n, b) for n, axis in axes.items() for b in axis.bands), key=lambda pair: pair[1].rms.value)
        text = f"{name} shakes most, by {_cell(name, band.rms)} in {_name(band)}"
        said.append(f"{text}{_explained(band)}.")
    return said


def _explained(band: Band) -> str:
    if band.share < STRONG:
        return ", over the whole band"
    share = f", {100 * band.share:.0f} % of its power"
    return (
        f"{share} at an edge of the band: it is no line"
        if band.line is None
        else f"{share} in a line at {number_text(band.line)} Hz"
    )


def draw(result: Result, review: Review) -> None:
    """Show densities, bars of the bands, and the table with intervals and lines."""
    for sensor, (unit, factor) in UNITS.items():
        axes = {name: axis for name, axis in result.axes.items() if name.startswith(sensor)}
        if not axes:
            continue
        curves = tuple(
            Curve(name, axis.frequency[1:], np.sqrt(axis.density[1:]) * factor, AXIS_COLORS[name[-1]], style="curve")
            for name, axis in axes.items()
        )
        review.figure(Figure(f"{sensor}: density of the vibration", "frequency [Hz]", f"density [{unit}/√Hz]", curves))
        review.bars(
            Bars(f"{sensor}: rms by band", unit, tuple(_bar(n, b) for n, axis in axes.items() for b in axis.bands))
        )
    review.table(_table(result))


def _bar(name: str, band: Band) -> Bar:
    rms = _shown(name, band.rms)
    return Bar(f"{name}, {_name(band)}", rms.value, AXIS_COLORS[name[-1]], rms.lower, rms.upper)


def _table(result: Result) -> Table:
    rows = tuple(
        (name, _name(band), str(_shown(name, band.rms)), *_line(band))
        for name, axis in result.axes.items()
        for band in axis.bands
    )
    caption = f"Intervals of {100 * result.level:g} %, from how much the segments differ. Share: of the band's power in the strongest line; none: the density is largest at an edge of the band."
    return Table(
        f"Vibration of {result.imu}", ("axis", "band", "rms [interval]", "strongest line", "share"), rows, caption
    )


def _line(band: Band) -> tuple[str, str]:
    return ("none", "—") if band.line is None else (f"{number_text(band.line)} Hz", f"{100 * band.share:.0f} %")


def _name(band: Band) -> str:
    return f"{band.low:g} to {band.high:.4g} Hz"


def _shown(name: str, rms: Estimate) -> Estimate:
    """Return an estimate in the unit in which it is shown."""
    unit, factor = UNITS[name.partition("_")[0]]
    return rms.scaled(factor, unit)


def _cell(name: str, rms: Estimate) -> str:
    shown = _shown(name, rms)
    return f"{number_text(shown.value)} {shown.unit}"

"""The figures of El-Diasty and others."""

from collections.abc import Mapping, Sequence

import numpy as np

from imuwb.analysis import Bars, Curve, Figure
from imuwb.colors import BLUE, GREEN, ORANGE, RED
from imuwb.conditioning import design_kaiser
from imuwb.identification import AllanDeviation, power_spectrum
from imuwb.statistics import Estimate
from imuwb.units import UNITS
from imuwb_plugins.kaiser.apply import draw, response_of
from imuwb_plugins.lssa.compute import run as lssa
from imuwb_plugins.lssa.parameters import Parameters as LssaParameters
from imuwb_plugins.lssa.show import draw as draw_lssa
from imuwb_plugins.reproduce.collected import figures_of, thinned, titled
from imuwb_plugins.reproduce.el_diasty.records import Record

COLORS = {-30: BLUE, 0: GREEN, 30: ORANGE, 60: RED}
AXIS_COLORS = {"gyro y": RED, "accel y": BLUE}
UNIT = {"gyro y": "deg/h", "accel y": "m/s²"}
CELSIUS, COEFFICIENT = "temperature [°C]", "coefficient of order 1 [1]"
SEGMENT = 1 << 14  #: samples


def allan_by_temperature(imu: str, axis: str, curves: Mapping[int, AllanDeviation]) -> Figure:
    """Return figures 4 to 7."""
    unit = UNITS[UNIT[axis]]
    lines = tuple(
        Curve(f"{celsius} °C", c.averaging_time, unit.from_si(1.0) * c.deviation, COLORS[celsius], style="curve")
        for celsius, c in curves.items()
    )
    return Figure(
        f"{imu}, {axis}: Allan deviation by temperature", "averaging time [s]", f"Allan deviation [{unit.name}]", lines
    )


def by_temperature(imu: str, found: Mapping[str, tuple[Sequence[int], Sequence[Estimate]]]) -> Figure:
    """Return figures 10 and 11."""
    return _coefficients(f"{imu}: coefficient of order 1 by temperature", CELSIUS, found)


def by_cutoff(imu: str, found: Mapping[str, tuple[Sequence[float | None], Sequence[Estimate]]]) -> Figure:
    """Return figures 14 and 15."""
    return _coefficients(f"{imu} at 30 °C: coefficient of order 1 by cutoff", "cutoff [Hz]", found)


def _coefficients(
    title: str, x_title: str, found: Mapping[str, tuple[Sequence[float | None], Sequence[Estimate]]]
) -> Figure:
    curves = tuple(
        Curve(
            axis, np.array(x, dtype=float), np.array([e.value for e in estimates]), AXIS_COLORS[axis],
            np.array([e.lower for e in estimates]), np.array([e.upper for e in estimates]),
        )
        for axis, (x, estimates) in found.items()
    )  # fmt: skip
    return Figure(title, x_title, COEFFICIENT, curves, x_scale="linear", y_scale="linear")


def spectrum(record: Record, after: Record | None = None) -> Figure:
    """Return figure 8, or, with the filtered record, figure 13."""
    curves = list[Curve]()
    for one, name, color in ((record, "raw", BLUE), (after, "after the low-pass at 16 Hz", ORANGE)):
        if one is not None:
            s = power_spectrum(one.values, one.dt, SEGMENT)
            decibels = 10 * np.log10(s.density.clip(1e-300))
            curves.append(thinned(Curve(name, s.frequency, decibels, color, style="curve")))
    what = "before and after the low-pass" if after is not None else "by the Fourier transform"
    return Figure(
        f"{record.imu}, {record.axis} at {record.celsius} °C: spectrum {what}", "frequency [Hz]",
        "one-sided density [dB of (rad/s)²/Hz]", tuple(curves), x_scale="linear", y_scale="linear",
    )  # fmt: skip


def least_squares(record: Record) -> tuple[Figure | Bars, ...]:
    """Return figure 9."""
    result = lssa([record.log()], LssaParameters(scale="decibels", peaks=3))
    return titled(figures_of(draw_lssa, result), "gyro y")


def kaiser(rate: float, f_pass: float, f_stop: float) -> tuple[Figure | Bars, ...]:
    """Return figure 12: magnitude and phase."""
    return figures_of(draw, response_of({"gyro": design_kaiser(rate, f_pass, f_stop)}))

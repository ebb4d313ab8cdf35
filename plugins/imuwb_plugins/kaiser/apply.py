"""The Kaiser low-pass applied to a log."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from imuwb.analysis import Curve, Figure, Review
from imuwb.arrays import Floats
from imuwb.colors import BLUE
from imuwb.conditioning import Change, KaiserFilter, condition_streams, design_kaiser, fir_change
from imuwb.log import Conditioning, Log
from imuwb_plugins.kaiser.parameters import Parameters

POINTS = 2001
FLOOR = 1e-9  #: gain, below which the curve of the magnitude is level
FAINTEST = -100.0  #: dB; at smaller magnitudes the phase is only rounding error


@dataclass(frozen=True, eq=False, slots=True)
class Applied:
    """The filter of each sensor, and the response of the first one."""

    filters: Mapping[str, KaiserFilter]
    frequency: Floats  #: (n,) Hz
    magnitude: Floats  #: (n,) dB
    phase: Floats  #: (n,) rad, of the causal filter; nan in the stop band


def condition(log: Log, parameters: Parameters) -> tuple[Log, Applied]:
    """Return the log with its IMUs filtered, and the filters.

    Raises:
        ValueError: bands that the rate of a sensor does not allow.
        MissingDataError: the log has no IMU.
    """
    log.imu()
    filters: dict[str, KaiserFilter] = {}

    def design(sensor: str, rate: float) -> Change:
        filters[sensor] = design_kaiser(rate, *parameters.bands, parameters.a_stop, parameters.a_pass)
        return fir_change(filters[sensor], causal=parameters.causal)

    changed = condition_streams(log, design)
    low, high = parameters.bands
    text = f"f_pass={low:g},f_stop={high:g},a_stop={parameters.a_stop:g},a_pass={parameters.a_pass:g},causal={parameters.causal}"
    taps = ", ".join(f"{sensor} {kaiser.taps.size}" for sensor, kaiser in filters.items())
    note = f"taps: {taps}; samples near the ends of each part, which the whole filter does not cover, are left out"
    delay = max(kaiser.delay for kaiser in filters.values()) if parameters.causal else 0.0
    step = Conditioning("kaiser", text.lower(), parameters.causal, delay, note, low)
    return replace(changed, conditioning=(*log.conditioning, step)), response_of(filters)


def response_of(filters: Mapping[str, KaiserFilter]) -> Applied:
    """Return filters with the response of the first one."""
    kaiser = next(iter(filters.values()))
    frequency = np.linspace(0, kaiser.rate / 2, POINTS)
    response = kaiser.response(frequency)
    magnitude = 20 * np.log10(np.abs(response).clip(FLOOR))
    phase = np.where(magnitude > FAINTEST, np.unwrap(np.angle(response)), np.nan)
    return Applied(filters, frequency, magnitude, phase)


def draw(applied: Applied, review: Review) -> None:
    """Show magnitude and phase (El-Diasty, figure 12)."""
    kaiser = next(iter(applied.filters.values()))
    title = f"Kaiser low-pass, {kaiser.taps.size} taps, pass to {kaiser.f_pass:g} Hz, stop from {kaiser.f_stop:g} Hz"
    for name, label, values in (
        (f"{title}: magnitude", "magnitude [dB]", applied.magnitude),
        (f"Phase of the causal filter, delay {kaiser.delay:.4g} s", "phase [rad]", applied.phase),
    ):
        curve = Curve(label.partition(" ")[0], applied.frequency, values, BLUE, style="curve")
        review.figure(Figure(name, "frequency [Hz]", label, (curve,), x_scale="linear", y_scale="linear"))

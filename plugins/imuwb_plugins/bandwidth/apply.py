"""The low-pass applied to a log."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from imuwb.analysis import Curve, Figure, Review
from imuwb.arrays import Floats
from imuwb.colors import BLUE
from imuwb.conditioning import Change, Lowpass, condition_streams, design_lowpass
from imuwb.log import Conditioning, Log
from imuwb_plugins.bandwidth.parameters import Parameters

LOWEST = 1e-4  #: share of the rate at which the curve of the magnitude begins
POINTS = 1000
FLOOR = 1e-6  #: gain, below which the curve is level


@dataclass(frozen=True, eq=False, slots=True)
class Applied:
    """The filter of each sensor, and the magnitude of the first one."""

    filters: Mapping[str, Lowpass]
    frequency: Floats  #: (n,) Hz
    magnitude: Floats  #: (n,) dB


def condition(log: Log, parameters: Parameters) -> tuple[Log, Applied]:
    """Return the log with its IMUs filtered, and the filters.

    Raises:
        ValueError: a cutoff that the rate of a sensor does not allow.
    """
    filters: dict[str, Lowpass] = {}

    def design(sensor: str, rate: float) -> Change:
        filters[sensor] = lowpass = design_lowpass(rate, parameters.cutoff, parameters.kind, parameters.order)
        return Change(lowpass.apply, lowpass.settling + 1, lowpass.settling)

    changed = condition_streams(log, design)
    text = f"cutoff={parameters.cutoff:g},kind={parameters.kind},order={parameters.order}"
    note = f"-3 dB at {', '.join(f'{sensor} {f.cutoff:.4g} Hz' for sensor, f in filters.items())}"
    delay, band = max(f.delay for f in filters.values()), min(f.band for f in filters.values())
    step = Conditioning("bandwidth", text, causal=True, delay=delay, note=note, band=band)
    return replace(changed, conditioning=(*log.conditioning, step)), _applied(filters)


def _applied(filters: Mapping[str, Lowpass]) -> Applied:
    first = next(iter(filters.values()))
    frequency = np.geomspace(first.rate * LOWEST, first.rate / 2, POINTS)
    return Applied(filters, frequency, 20 * np.log10(np.abs(first.response(frequency)).clip(FLOOR)))


def draw(applied: Applied, review: Review) -> None:
    """Show the magnitude."""
    first = next(iter(applied.filters.values()))
    review.figure(Figure(
        f"Low-pass of {first.cutoff:g} Hz, delay {first.delay:.3g} s", "frequency [Hz]", "magnitude [dB]",
        (Curve("magnitude", applied.frequency, applied.magnitude, BLUE, style="curve"),), y_scale="linear",
    ))  # fmt: skip

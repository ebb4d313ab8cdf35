"""Kaiser low-pass: linear phase, from the edges of its bands or from its cutoff and width."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

if TYPE_CHECKING:
    from imuwb.analysis import Review
    from imuwb.conditioning import KaiserFilter
    from imuwb.log import Log


WIDTH = 4.0  #: Hz


@dataclass(frozen=True)
class Parameters:
    """What can be asked of the filter."""

    f_pass: Annotated[float | None, "Hz, end of the pass band"] = None
    f_stop: Annotated[float | None, "Hz, begin of the stop band"] = None
    fc: Annotated[float | None, "Hz, midway between them, instead"] = None
    width: Annotated[float | None, "Hz, of the transition, with fc; None: 4"] = None
    a_stop: Annotated[float, "dB, least attenuation in the stop band"] = 100.0
    a_pass: Annotated[float, "dB, most ripple in the pass band"] = 0.0001
    causal: Annotated[bool, "late by the filter's delay, instead of knowing what comes"] = False

    def __post_init__(self) -> None:
        """Check that the bands are given, once."""
        edges = self.f_pass is not None and self.f_stop is not None
        if edges == (self.fc is not None) or (self.f_pass is None) != (self.f_stop is None):
            message = "give either f_pass and f_stop, or fc (and width), in Hz"
            raise ValueError(message)
        if edges and self.width is not None:
            message = (
                f"width is {self.width} Hz; it goes with fc: f_pass and f_stop already say how wide the transition is"
            )
            raise ValueError(message)

    @property
    def bands(self) -> tuple[float, float]:
        """Return the edges, Hz."""
        if self.fc is not None:
            half = (WIDTH if self.width is None else self.width) / 2
            return self.fc - half, self.fc + half
        return self.f_pass or 0.0, self.f_stop or 0.0


def condition(log: Log, parameters: Parameters) -> tuple[Log, dict[str, KaiserFilter]]:
    """Return the log with its IMUs filtered, and the filter of each sensor."""
    from dataclasses import replace  # noqa: PLC0415 - help must not wait

    from imuwb.conditioning import Change, condition_streams, design_kaiser, filtered  # noqa: PLC0415 - help must not wait
    from imuwb.log import Conditioning  # noqa: PLC0415 - as above

    found: dict[str, KaiserFilter] = {}

    def design(sensor: str, rate: float) -> Change:
        found[sensor] = kaiser = design_kaiser(rate, *parameters.bands, parameters.a_stop, parameters.a_pass)
        size = kaiser.taps.size
        first, last = (size - 1, 0) if parameters.causal else (size // 2, size // 2)
        return Change(lambda values: filtered(values, kaiser.taps), size, first, last)

    low, high = parameters.bands
    text = f"f_pass={low:g},f_stop={high:g},a_stop={parameters.a_stop:g},a_pass={parameters.a_pass:g},causal={parameters.causal}"
    changed = condition_streams(log, design)
    longest = max(kaiser.delay for kaiser in found.values())
    taps = ", ".join(f"{sensor} {kaiser.taps.size}" for sensor, kaiser in found.items())
    note = f"taps: {taps}; the ends of each part, where the filter does not lie on samples only, are left out"
    made = Conditioning("kaiser", text.lower(), parameters.causal, longest if parameters.causal else 0.0, note, low)
    return replace(changed, conditioning=(*log.conditioning, made)), found


def draw(found: dict[str, KaiserFilter], review: Review) -> None:
    """Show magnitude and phase (El-Diasty, figure 12)."""
    import numpy as np  # noqa: PLC0415 - help must not wait

    from imuwb.analysis import Curve, Figure  # noqa: PLC0415 - as above

    kaiser = next(iter(found.values()))
    f = np.linspace(0, kaiser.rate / 2, 2001)
    response = kaiser.response(f)
    decibel = 20 * np.log10(np.abs(response).clip(1e-9))
    inside = decibel > -100  # noqa: PLR2004 - beyond, the phase is that of rounding
    phase = np.where(inside, np.unwrap(np.angle(response)), np.nan)
    color = (76, 120, 168)
    title = f"Kaiser low-pass, {kaiser.taps.size} taps, pass to {kaiser.f_pass:g} Hz, stop from {kaiser.f_stop:g} Hz"
    review.figure(Figure(
        f"{title}: magnitude", "frequency [Hz]", "magnitude [dB]", (Curve("magnitude", f, decibel, color, style="curve"),),
        x_scale="linear", y_scale="linear",
    ))  # fmt: skip
    review.figure(Figure(
        f"Phase of the causal filter, delay {kaiser.delay:.4g} s", "frequency [Hz]", "phase [rad]",
        (Curve("phase", f, phase, color, style="curve"),), x_scale="linear", y_scale="linear",
    ))  # fmt: skip

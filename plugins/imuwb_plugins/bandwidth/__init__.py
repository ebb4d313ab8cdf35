"""A sensor's own low-pass: Butterworth, or a moving average. Causal, with its delay."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Literal

if TYPE_CHECKING:
    from imuwb.analysis import Review
    from imuwb.conditioning import Lowpass
    from imuwb.log import Log


@dataclass(frozen=True)
class Parameters:
    """What can be asked of the filter."""

    cutoff: Annotated[float, "Hz, -3 dB; below half the rate"]
    kind: Annotated[Literal["butterworth", "moving-average"], "of filter"] = "butterworth"
    order: Annotated[int, "of a Butterworth filter"] = 2

    def __post_init__(self) -> None:
        """Check the cutoff."""
        if not self.cutoff > 0:
            message = f"cutoff is {self.cutoff} Hz; it must be positive"
            raise ValueError(message)


def condition(log: Log, parameters: Parameters) -> tuple[Log, dict[str, Lowpass]]:
    """Return the log with its IMUs filtered, and the filter of each sensor."""
    from dataclasses import replace  # noqa: PLC0415 - help must not wait

    from imuwb.conditioning import Change, condition_streams, design_lowpass  # noqa: PLC0415 - as above
    from imuwb.log import Conditioning  # noqa: PLC0415 - as above

    found: dict[str, Lowpass] = {}

    def design(sensor: str, rate: float) -> Change:
        found[sensor] = lowpass = design_lowpass(rate, parameters.cutoff, parameters.kind, parameters.order)
        return Change(lowpass.apply, lowpass.settling + 1, lowpass.settling)

    text = f"cutoff={parameters.cutoff:g},kind={parameters.kind},order={parameters.order}"
    changed = condition_streams(log, design)
    reached = ", ".join(f"{sensor} {f.cutoff:.4g} Hz" for sensor, f in found.items())
    late, flat = max(f.delay for f in found.values()), min(f.band for f in found.values())
    made = Conditioning("bandwidth", text, causal=True, delay=late, note=f"-3 dB at {reached}", band=flat)
    return replace(changed, conditioning=(*log.conditioning, made)), found


def draw(found: dict[str, Lowpass], review: Review) -> None:
    """Show the magnitude."""
    import numpy as np  # noqa: PLC0415 - help must not wait

    from imuwb.analysis import Curve, Figure  # noqa: PLC0415 - as above

    lowpass = next(iter(found.values()))
    f = np.geomspace(lowpass.rate * 1e-4, lowpass.rate / 2, 1000)
    magnitude = 20 * np.log10(np.abs(lowpass.response(f)).clip(1e-6))
    review.figure(Figure(
        f"Low-pass of {lowpass.cutoff:g} Hz, delay {lowpass.delay:.3g} s", "frequency [Hz]", "magnitude [dB]",
        (Curve("magnitude", f, magnitude, (76, 120, 168), style="curve"),), y_scale="linear",
    ))  # fmt: skip

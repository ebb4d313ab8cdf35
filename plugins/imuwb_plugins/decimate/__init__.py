"""A lower rate: behind a Kaiser low-pass, so that nothing folds, or by leaving samples out."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

if TYPE_CHECKING:
    from imuwb.log import Log

PASS, STOP = 0.4, 0.5  #: edges of the anti-alias filter, of the new rate
ROUNDING = 1e-3  #: of a factor, that it may miss a whole number by


@dataclass(frozen=True)
class Parameters:
    """What can be asked."""

    rate: Annotated[float | None, "Hz, a whole fraction of the log's"] = None
    factor: Annotated[int | None, "keep one of so many samples, instead"] = None
    anti_alias: Annotated[bool, "filter first; without, what is above half the new rate folds down"] = True
    causal: Annotated[bool, "late by the filter's delay, instead of knowing what comes"] = False

    def __post_init__(self) -> None:
        """Check that one of the two is given."""
        given = self.rate if self.rate is not None else self.factor
        if (self.rate is None) == (self.factor is None) or not given or not 0 < given < math.inf:
            message = "give either rate (Hz) or factor (a whole number), positive"
            raise ValueError(message)


def condition(log: Log, parameters: Parameters) -> tuple[Log, dict[str, float]]:
    """Return the log at the lower rate, and the new rate of each sensor."""
    from dataclasses import replace  # noqa: PLC0415 - help must not wait

    from imuwb.conditioning import Change, condition_streams, design_kaiser, filtered  # noqa: PLC0415 - as above
    from imuwb.log import Conditioning  # noqa: PLC0415 - as above

    rates: dict[str, float] = {}
    delays, bands = [0.0], list[float]()

    def design(sensor: str, rate: float) -> Change:
        factor = _factor(rate, parameters)
        rates[sensor] = rate / factor
        if factor == 1 or not parameters.anti_alias:
            return Change(lambda values: values[::factor], step=factor)
        try:
            kaiser = design_kaiser(rate, PASS * rate / factor, STOP * rate / factor)
        except ValueError as error:
            message = f"one of {factor} samples: the anti-alias filter would be too long; decimate in steps"
            raise ValueError(message) from error
        bands.append(PASS * rate / factor)
        delays.append(kaiser.delay if parameters.causal else 0.0)
        size = kaiser.taps.size
        first, last = (size - 1, 0) if parameters.causal else (size // 2, size // 2)
        return Change(lambda values: filtered(values, kaiser.taps)[::factor], size, first, last, factor)

    wanted = f"rate={parameters.rate:g}" if parameters.rate is not None else f"factor={parameters.factor}"
    text = f"{wanted},anti_alias={parameters.anti_alias},causal={parameters.causal}".lower()
    causal = parameters.causal or not parameters.anti_alias
    changed = condition_streams(log, design)
    made = Conditioning("decimate", text, causal, max(delays), band=min(bands, default=None))
    return replace(changed, conditioning=(*log.conditioning, made)), rates


def _factor(rate: float, parameters: Parameters) -> int:
    if parameters.factor is not None:
        return parameters.factor
    wanted = parameters.rate or 0.0
    factor = round(rate / wanted)
    if factor < 1 or abs(rate / wanted / factor - 1) > ROUNDING:
        message = f"a rate of {wanted:g} Hz from one of {rate:g} Hz: it must be {rate:g} divided by a whole number"
        raise ValueError(message)
    return factor

"""A log at a lower rate."""

from dataclasses import replace

from imuwb.conditioning import Change, KaiserFilter, condition_streams, design_kaiser, fir_change
from imuwb.log import Conditioning, Log
from imuwb_plugins.decimate.parameters import Parameters

PASS, STOP = 0.4, 0.5  #: edges of the anti-alias filter, as shares of the new rate
ROUNDING = 1e-3  #: share by which the ratio of the rates may miss a whole number


def condition(log: Log, parameters: Parameters) -> tuple[Log, dict[str, float]]:
    """Return the log at the lower rate, and the new rate of each sensor.

    Raises:
        ValueError: a rate that the log's rate is no multiple of, or a factor that needs too long a filter.
    """
    rates: dict[str, float] = {}
    filters: list[KaiserFilter] = []

    def design(sensor: str, rate: float) -> Change:
        factor = _factor(rate, parameters)
        rates[sensor] = rate / factor
        if factor == 1 or not parameters.anti_alias:
            return Change(lambda values: values[::factor], step=factor)
        filters.append(_anti_alias(rate, factor))
        return fir_change(filters[-1], causal=parameters.causal, step=factor)

    changed = condition_streams(log, design)
    wanted = f"rate={parameters.rate:g}" if parameters.rate is not None else f"factor={parameters.factor}"
    text = f"{wanted},anti_alias={parameters.anti_alias},causal={parameters.causal}".lower()
    delay = max((f.delay for f in filters), default=0.0) if parameters.causal else 0.0
    band = min((f.f_pass for f in filters), default=None)
    step = Conditioning("decimate", text, parameters.causal or not parameters.anti_alias, delay, band=band)
    return replace(changed, conditioning=(*log.conditioning, step)), rates


def _anti_alias(rate: float, factor: int) -> KaiserFilter:
    try:
        return design_kaiser(rate, PASS * rate / factor, STOP * rate / factor)
    except ValueError as error:
        raise ValueError(
            f"factor is {factor}; the anti-alias filter would be too long; decimate in several steps"
        ) from error


def _factor(rate: float, parameters: Parameters) -> int:
    if parameters.factor is not None:
        return parameters.factor
    wanted = parameters.rate or 0.0
    factor = round(rate / wanted)
    if factor < 1 or abs(rate / wanted / factor - 1) > ROUNDING:
        raise ValueError(f"rate is {wanted:g} Hz; it must be the log's rate of {rate:g} Hz divided by a whole number")
    return factor

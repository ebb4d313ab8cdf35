"""The answer of the autoregressive analysis: the order that suffices, and what the model of order 1 means."""

import math

from imuwb.analysis import Answer, Step
from imuwb.texts import number_text, seconds_text
from imuwb_plugins.autoregressive.result import AutoregressiveAxis, Result

DRIVE = Step("imuwb outage DRIVE --error-model {model} --models paper", "what such a model does to a drift")
NOISE = Step("imuwb noise {log}", "the noise of a model with physical terms")


def answer(result: Result) -> Answer:
    """Return the chosen order of each axis, and the model of order 1."""
    rows = tuple(_row(axis, r) for axis, r in result.axes.items())
    rate = " and ".join(dict.fromkeys(f"{number_text(1 / r.dt)} Hz" for r in result.axes.values() if r.dt))
    sentences = [f"{axis.replace('_', ' ')}: {r.reading}." for axis, r in result.axes.items() if r.reading][:2]
    if not result.conditioned:
        sentences.insert(0, "The samples are not filtered: at this rate white noise hides the slow part of the bias.")
    headings = ("", "order by BIC", "alpha of order 1", "correlation time")
    return Answer(f"models at {rate}", headings, rows, tuple(sentences), (NOISE, DRIVE))


def _row(axis: str, r: AutoregressiveAxis) -> tuple[str, ...]:
    name = axis.replace("_", " ")
    if r.why_none is not None or not r.orders:
        return name, "—", r.why_none or "—"
    alpha = float(r.orders[0].alpha[0])
    time = seconds_text(-r.dt / math.log(-alpha)) if -1 < alpha < 0 else "none"
    return name, str(r.chosen or "—"), f"{alpha:.4f}", time

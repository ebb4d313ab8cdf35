"""The answer of the autocorrelation: whether each axis is white, and which Gauss-Markov process fits it."""

from imuwb.analysis import Answer, Step
from imuwb.texts import number_text, seconds_text
from imuwb_plugins.autocorrelation.result import CorrelationAxis, Result
from imuwb_plugins.autocorrelation.show import denoised_figures

NOISE = Step("imuwb noise {log}", "all estimators side by side, and a model")


def answer(result: Result) -> Answer:
    """Return the verdict of each axis, before and after denoising."""
    rows = tuple(_row(axis, r) for axis, r in result.axes.items())
    rate = " and ".join(dict.fromkeys(f"{number_text(1 / dt)} Hz" for dt in result.interval.values()))
    headings = ("", "falls to 1/e after", "Gauss-Markov process", "after denoising")
    first = next((r for r in result.axes.values() if r.why_none is None), None)
    sentences = () if first is None else (f"{next(iter(result.axes)).replace('_', ' ')}: {first.verdict}.",)
    return Answer(
        f"{rate}, denoised by {result.denoise} levels" if result.denoise else rate,
        headings,
        rows,
        sentences,
        (NOISE,),
        figure=next(iter(denoised_figures(result)), None),
    )


def _row(axis: str, r: CorrelationAxis) -> tuple[str, ...]:
    name = axis.replace("_", " ")
    if r.why_none is not None:
        return name, "—", "—", r.why_none
    markov = "none" if r.gauss_markov is None else f"correlation time {seconds_text(r.gauss_markov.Tc.value)}"
    after = r.denoised.falls_to if r.denoised is not None else None
    return name, _time(r.falls_to), markov, "—" if r.denoised is None else f"1/e after {_time(after)}"


def _time(seconds: float | None) -> str:
    return "the record" if seconds is None else seconds_text(seconds)

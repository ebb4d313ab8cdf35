"""Noise of a still IMU: all noise analyses together, one recording, one error model.

Allan deviation, likelihood, wavelet variance, spectrum, autocorrelation and autoregressive models of one log, laid side by
side, with a verdict for each axis. Several logs of one sensor are compared: which coefficients differ, and how much the bias
changes from one turn-on to the next. --study repeats it through conditioners.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

from imuwb.errors import MissingDataError
from imuwb.progress import tracked
from imuwb_plugins import allan, autocorrelation, autoregressive, psd

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from imuwb.analysis import Case, Finding, Review
    from imuwb.log import Log
    from imuwb.stochastic import ImuErrorModel
    from imuwb_plugins.noise.denoising import Denoising
    from imuwb_plugins.noise.repeatability import Repeatability
    from imuwb_plugins.noise.settings import Study

LOGS = (1, None)
LEAVES_MODEL = True
DEMO = "still"
#: in the order of their tabs
ANALYSES: dict[str, Any] = {
    "allan": allan,
    "psd": psd,
    "autocorrelation": autocorrelation,
    "autoregressive": autoregressive,
}
TITLES = {"allan": "Allan", "psd": "Spectrum", "autocorrelation": "Correlation", "autoregressive": "Autoregression"}


@dataclass(frozen=True)
class Parameters:
    """Options of ``imuwb noise``."""

    choose: Annotated[bool, "compare sums of processes (the slowest part)"] = True
    denoise: Annotated[int, "levels of wavelet denoising on the denoising tab; 0: none"] = 6
    level: Annotated[float, "of all intervals and limits"] = 0.95

    def __post_init__(self) -> None:
        """Check the values."""
        if not 0.6 <= self.level < 1:  # noqa: PLR2004 - a limit at even odds is none
            message = f"level is {self.level}; it must be at least 0.6 and below 1"
            raise ValueError(message)
        if not 0 <= self.denoise <= 20:  # noqa: PLR2004 - deeper than any log
            message = f"denoise is {self.denoise} levels; it must be 0 to 20"
            raise ValueError(message)


@dataclass(frozen=True, eq=False, slots=True)
class Result:
    """What all analyses found."""

    axes: dict[str, dict[str, Any]]  #: axis -> estimators, headline, verdict
    parts: tuple[dict[str, Any], ...]  #: of each log: analysis -> its own result
    denoising: Denoising | None
    repeatability: Repeatability | None
    findings: tuple[tuple[Finding, ...], ...]  #: of each log
    missing: tuple[str, ...] = ()  #: what a log was too short, or too gapped, for


def run(logs: Sequence[Log], parameters: Parameters) -> Result:
    """Return what all analyses find; of several logs, the Allan analysis of each and their comparison."""
    from imuwb_plugins.noise import denoising, repeatability, summary  # noqa: PLC0415 - help must not wait for numpy

    names = list(ANALYSES) if len(logs) == 1 else ["allan"]
    made = _parameters(parameters)
    parts: list[dict[str, Any]] = []
    found: list[tuple[Finding, ...]] = []
    missing: list[str] = []
    for log in tracked(logs, len(logs)):
        results: dict[str, Any] = {}
        for name in tracked(names, len(names)):
            try:
                results[name] = ANALYSES[name].run([log], made[name])
            except MissingDataError as error:
                if name == "allan":  # without it there is no model
                    raise
                missing.append(f"no {TITLES[name].lower()} tab: {error}")
        parts.append(results)
        found.append(tuple(f for name, result in results.items() for f in ANALYSES[name].findings(result)))
    together = repeatability.compare(logs, found, parameters.level) if len(logs) > 1 else None
    quiet = denoising.denoising(logs[0], parameters.denoise) if len(logs) == 1 and parameters.denoise else None
    return Result(summary.axes(found[0]), tuple(parts), quiet, together, tuple(found), tuple(missing))


def draw(result: Result, review: Review) -> None:
    """Show the summary, then each analysis on its own tab."""
    from imuwb_plugins.noise import denoising, repeatability, summary  # noqa: PLC0415 - as above

    review.tab("Summary")
    for text in result.missing:
        review.note(text)
    if result.repeatability is not None:
        repeatability.draw(result.repeatability, review)
    else:
        summary.draw(result.axes, result.findings[0], review)
    for i, part in enumerate(result.parts):
        for name, content in part.items():
            whose = result.repeatability.names[i] if result.repeatability is not None else ""
            review.tab(f"{TITLES[name]} {whose}".strip())
            ANALYSES[name].draw(content, review)
    if result.denoising is not None:
        review.tab("Denoising")
        denoising.draw(result.denoising, review)


def error_model(result: Result) -> ImuErrorModel:
    """Return the headline's sums; of several logs their mean, with the turn-on bias."""
    from imuwb_plugins.noise import model  # noqa: PLC0415 - as above

    models = [allan.error_model(part["allan"]) for part in result.parts]
    return model.combined(models, result.repeatability)


def study(cases: Iterable[Case], parameters: Parameters) -> Study:
    """Return the Allan deviation and the coefficients in each setting."""
    from imuwb_plugins.noise import settings  # noqa: PLC0415 - as above

    return settings.study(cases, parameters.level)


def draw_study(result: Study, review: Review) -> None:
    """Show the settings over each other."""
    from imuwb_plugins.noise import settings  # noqa: PLC0415 - as above

    settings.draw(result, review)


def _parameters(parameters: Parameters) -> dict[str, Any]:
    """Return the parameters of each analysis."""
    level = parameters.level
    return {
        "allan": ANALYSES["allan"].Parameters(choose=parameters.choose, model="headline", level=level),
        "psd": ANALYSES["psd"].Parameters(level=level),
        "autocorrelation": ANALYSES["autocorrelation"].Parameters(level=level, denoise=parameters.denoise),
        "autoregressive": ANALYSES["autoregressive"].Parameters(),
    }

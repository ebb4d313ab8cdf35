"""All noise analyses of one log, or the comparison of several logs."""

from collections.abc import Sequence
from typing import Any

from imuwb.analysis import Finding
from imuwb.errors import MissingDataError
from imuwb.log import Log
from imuwb.notes import Note
from imuwb.progress import tracked
from imuwb.replay import of_static
from imuwb_plugins import allan, autocorrelation, autoregressive, psd
from imuwb_plugins.allan import imus as allan_imus
from imuwb_plugins.noise import summary
from imuwb_plugins.noise.denoising import denoising
from imuwb_plugins.noise.parameters import Parameters
from imuwb_plugins.noise.repeatability import compare
from imuwb_plugins.noise.result import TITLES, Result

ANALYSES: dict[str, Any] = {
    "allan": allan, "psd": psd, "autocorrelation": autocorrelation, "autoregressive": autoregressive
}  # fmt: skip


def run(logs: Sequence[Log], parameters: Parameters) -> Result:
    """Return the results of all analyses of one log; of several logs, the Allan analysis of each and their comparison.

    Raises:
        MissingDataError: a log has no Allan deviation, or the logs have no axis in common.
        UsageError: a log is given twice.
    """
    parts: list[dict[str, Any]] = []
    findings: list[tuple[Finding, ...]] = []
    notes: list[Note] = []
    for log in tracked(logs, len(logs)):
        results, missing = _results(log, parameters, list(ANALYSES) if len(logs) == 1 else ["allan"])
        parts.append(results)
        notes += missing
        findings.append(tuple(f for name, result in results.items() for f in ANALYSES[name].findings(result)))
    repeatability = compare(logs, findings, parameters.level) if len(logs) > 1 else None
    denoised = denoising(logs[0], parameters.denoise) if len(logs) == 1 and parameters.denoise else None
    processes = of_static(logs[0].imu())[0] if len(logs) == 1 else {}
    return Result(summary.axes(findings[0]), tuple(parts), denoised, processes, repeatability, tuple(notes))


def compare_imus(logs: Sequence[Log], parameters: Parameters) -> allan_imus.ImuComparison:
    """Return the noise of each IMU of a log, one log for each; errors as of the Allan analysis's."""
    return allan_imus.compare_imus(logs, _options(parameters)["allan"])


def _results(log: Log, parameters: Parameters, names: Sequence[str]) -> tuple[dict[str, Any], list[Note]]:
    """Return the results by analysis, and notes on the analyses that the log does not allow."""
    results: dict[str, Any] = {}
    missing: list[Note] = []
    options = _options(parameters)
    for name in tracked(names, len(names)):
        try:
            results[name] = ANALYSES[name].run([log], options[name])
        except MissingDataError as error:
            if name == "allan":  # without the Allan analysis there is no error model
                raise
            missing.append(Note("no-analysis", f"no {TITLES[name].lower()} tab: {error}"))
    return results, missing


def _options(parameters: Parameters) -> dict[str, Any]:
    """Return the parameters of each analysis."""
    level = parameters.level
    return {
        "allan": ANALYSES["allan"].Parameters(choose=parameters.choose, model="headline", level=level),
        "psd": ANALYSES["psd"].Parameters(level=level),
        "autocorrelation": ANALYSES["autocorrelation"].Parameters(level=level, denoise=parameters.denoise),
        "autoregressive": ANALYSES["autoregressive"].Parameters(),
    }

"""What a person should know of an axis, one line each, and act on."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from imuwb.analysis import Finding
from imuwb.stochastic import FlickerNoise, Quantization, RandomWalk, RateRamp, Sinusoid, WhiteNoise
from imuwb.texts import seconds_text

if TYPE_CHECKING:
    from imuwb.statistics import Coefficient
    from imuwb.stochastic import Process
    from imuwb_plugins.allan.result import AxisResult, Result

_WORDS: dict[type, str] = {
    Quantization: "quantization", WhiteNoise: "white noise", FlickerNoise: "bias instability", RandomWalk: "random walk",
    RateRamp: "ramp", Sinusoid: "lines",
}  # fmt: skip
MUCH = 0.2  #: of a logarithm, about a fifth: change of the deviation that puts figures in doubt
DECISIVE = 3.0  #: times the limit of K, whose walk a longer record would show
LONGER = 1.5  #: times the record; a wish for less is none


def findings(result: Result) -> tuple[Finding, ...]:
    """Return what each estimator says of each axis; remarks go with the headline."""
    found: list[Finding] = []
    for axis, r in result.axes.items():
        remarks = tuple(_remarks(result, axis, r))
        if r.estimates is None:
            found.append(Finding(axis, "allan", r.coefficients, remarks, headline=True))
            continue
        for name, coefficients in r.estimates.by.items():
            headline = name == r.estimates.headline
            found.append(Finding(axis, name, coefficients, remarks if headline else (), headline=headline))
    return tuple(found)


def _remarks(result: Result, axis: str, found: AxisResult) -> list[str]:
    if found.why_no_fit is not None:
        return [f"SUSPICIOUS: {found.why_no_fit}"]
    said = [_dominant(found)]
    coefficients = found.estimates.by[found.estimates.headline] if found.estimates else found.coefficients
    dt = 1 / result.rate_hz[axis.partition("_")[0]]
    q, n, k, ramp = (coefficients.get(x) for x in ("Q", "N", "K", "R"))
    if q is not None and q.lower and n is not None and n.value and q.value and 3 * q.value**2 / dt**2 > n.value**2 / dt:
        said.append(f"quantization-limited below {seconds_text(3 * q.value**2 / n.value**2)}")
    if ramp is not None and ramp.value:
        said.append(f"drifts: {ramp.value:.3g} {ramp.unit}; let it warm up, or hold its temperature")
    if k is not None and not k.lower:
        wish = _long_enough(coefficients, result.duration)
        said.append(f"too short for K: {wish}" if wish else "no random walk seen")
    if found.fit is not None and found.fit.probability < 1e-3:  # noqa: PLR2004 - one in a thousand
        said.append(
            f"SUSPICIOUS: no sum of these processes explains the curve (chi-square {found.fit.misfit:.2g} per degree of freedom)"
        )
    if found.estimates is not None:
        said += _beside(found)
    return said


def _beside(found: AxisResult) -> list[str]:
    estimates = found.estimates
    if estimates is None:
        return []
    said: list[str] = []
    if estimates.stationarity is not None and not estimates.stationarity.stationary:
        s = estimates.stationarity
        word = "SUSPICIOUS: not stationary" if abs(np.log(s.worst_ratio)) > MUCH else "not quite stationary"
        said.append(
            f"{word}: the part from {s.start[s.worst_part]:.0f} s on has {s.worst_ratio:.2g} times the usual deviation at "
            f"{s.worst_time:.3g} s"
        )
    if not estimates.agree:
        letters = dict.fromkeys(text.partition(":")[0] for text in estimates.disagreements)
        said.append(f"estimators differ in {', '.join(letters)}")
    if estimates.choice is not None:
        best = estimates.choice.best
        sure = "clearly " if estimates.choice.clear else ""
        said.append(f"{sure}best sum: {best.name}")
    return said


def _dominant(found: AxisResult) -> str:
    """Return which process rules where: "white noise to 12 s, bias instability to 1600 s"."""
    processes = found.processes
    if processes is None or not processes.terms or not found.averaging_time.size:
        return "no process is identified"
    tau = np.geomspace(found.averaging_time[0], found.averaging_time[-1], 200)
    dt = float(found.averaging_time[0])
    kinds: list[type] = []
    parts: list[np.ndarray[tuple[int], np.dtype[np.float64]]] = []
    for term in processes.terms:
        part = term.allan_variance(tau, dt)
        if type(term) in kinds:
            parts[kinds.index(type(term))] += part
        else:
            kinds.append(type(term))
            parts.append(part)
    ruler = np.argmax(parts, axis=0)
    edges = np.append(np.flatnonzero(np.diff(ruler)), tau.size - 1)
    return ", ".join(
        f"{_WORDS.get(kinds[ruler[e]], _name(processes.terms[0]))} to {seconds_text(float(tau[e]))}" for e in edges
    )


def _name(term: Process) -> str:
    return str(getattr(term, "name", "noise"))


def _long_enough(coefficients: dict[str, Coefficient], duration: float) -> str | None:
    """Return how long a record would have to be to show a walk of the size of K's limit; None where this one would do.

    A walk shows when its Allan variance at a tenth of the record, K² T/30, is above that of the other terms there.
    """
    k = coefficients["K"].upper
    n, b = (coefficients[x].value or 0.0 for x in ("N", "B"))
    if not k:
        return None
    # K² t/3 = DECISIVE² (N²/t + (2 ln2/pi) B²) at t = T/10
    a, c, d = k**2 / 3, -(DECISIVE**2) * 2 * np.log(2) / np.pi * b**2, -(DECISIVE**2) * n**2
    needed = 10 * float((-c + np.sqrt(c**2 - 4 * a * d)) / (2 * a))
    if needed < LONGER * duration:
        return None
    unit, size = next((u, x) for u, x in (("h", 3600.0), ("min", 60.0), ("s", 1.0)) if needed > 2 * x or u == "s")
    text = f"{needed / size:.0f} {unit}"
    return f"one as large as its limit would show in {text}"

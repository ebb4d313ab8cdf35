"""Remarks on the noise of an axis, one line each, for a person to act on."""

from collections.abc import Iterator, Mapping

import numpy as np

from imuwb.analysis import SUSPICIOUS, Finding
from imuwb.notes import Note
from imuwb.statistics import Coefficient
from imuwb.stochastic import FlickerNoise, Quantization, RandomWalk, RateRamp, Sinusoid, WhiteNoise
from imuwb.texts import number_text, seconds_text
from imuwb_plugins.allan.notes import UNEXPLAINED
from imuwb_plugins.allan.result import AllanAxis, EstimatorComparison, Result

_NAMES: dict[type, str] = {
    Quantization: "quantization", WhiteNoise: "white noise", FlickerNoise: "bias instability", RandomWalk: "random walk",
    RateRamp: "ramp", Sinusoid: "lines",
}  # fmt: skip
MUCH = 0.2  #: change of the Allan deviation's logarithm, about a fifth, that puts the coefficients in doubt
DECISIVE = 3.0  #: Allan deviation of a random walk that shows, over that of the other terms, at a tenth of the record
LONGER = 1.5  #: ratio to the length of the record; a longer record is recommended only above this
POINTS = 200  #: averaging times at which the terms are compared


def findings(result: Result) -> tuple[Finding, ...]:
    """Return the coefficients of each estimator and axis; the headline's finding has the remarks."""
    all_findings: list[Finding] = []
    for axis, r in result.axes.items():
        remarks = tuple(_remarks(result, axis, r))
        if r.estimates is None:
            all_findings.append(Finding(axis, "allan", r.coefficients, remarks, headline=True))
            continue
        for name, coefficients in r.estimates.by.items():
            headline = name == r.estimates.headline
            all_findings.append(Finding(axis, name, coefficients, remarks if headline else (), headline=headline))
    return tuple(all_findings)


def _remarks(result: Result, axis: str, r: AllanAxis) -> Iterator[Note]:
    if r.why_no_fit is not None:
        yield Note("no-fit", f"{SUSPICIOUS}{r.why_no_fit}")
        return
    yield Note("dominant", _dominant(r))
    coefficients = r.estimates.by[r.estimates.headline] if r.estimates else r.coefficients
    dt = 1 / result.rate_hz[axis.partition("_")[0]]
    q, n, k, ramp = (coefficients.get(x) for x in ("Q", "N", "K", "R"))
    if q is not None and q.lower and n is not None and n.value and q.value and 3 * q.value**2 / dt**2 > n.value**2 / dt:
        yield Note("quantization", f"quantization-limited below {seconds_text(3 * q.value**2 / n.value**2)}")
    if ramp is not None and ramp.value:
        yield Note(
            "ramp", f"drifts by {ramp.value:.3g} {ramp.unit}; let the sensor warm up, or keep its temperature constant"
        )
    if k is not None and not k.lower:
        wish = _long_enough(coefficients, result.duration)
        text = (
            f"too short for K: a random walk as large as K's limit would show in a record of {wish}"
            if wish
            else "no random walk"
        )
        yield Note("too-short" if wish else "no-walk", text)
    if r.fit is not None and r.fit.probability < UNEXPLAINED:
        yield Note(
            "unexplained",
            f"{SUSPICIOUS}no sum of these processes explains the curve (chi-square {r.fit.misfit:.2g} per degree of freedom)",
        )
    if r.estimates is not None:
        yield from _comparison(r.estimates)


def _comparison(estimates: EstimatorComparison) -> Iterator[Note]:
    s = estimates.stationarity
    if s is not None and not s.stationary:
        verdict = f"{SUSPICIOUS}not stationary" if abs(np.log(s.worst_ratio)) > MUCH else "not quite stationary"
        yield Note(
            "not-stationary",
            f"{verdict}: the part from {s.start[s.worst_part]:.0f} s has {s.worst_ratio:.2g} times the usual Allan deviation at "
            f"{number_text(s.worst_time)} s",
        )
    if not estimates.agree:
        letters = dict.fromkeys(text.partition(":")[0] for text in estimates.disagreements)
        yield Note("differ", f"estimators differ in {', '.join(letters)}")
    if estimates.choice is not None:
        clearly = "clearly " if estimates.choice.clear else ""
        yield Note("best-sum", f"{clearly}best sum: {estimates.choice.best.name}")


def _dominant(r: AllanAxis) -> str:
    """Return the dominant process by averaging time, such as "white noise to 12 s, bias instability to 1600 s"."""
    processes = r.processes
    if processes is None or not processes.terms or not r.averaging_time.size:
        return "no process is identified"
    tau = np.geomspace(r.averaging_time[0], r.averaging_time[-1], POINTS)
    parts: dict[type, np.ndarray[tuple[int], np.dtype[np.float64]]] = {}
    for term in processes.terms:
        part = term.allan_variance(tau, float(r.averaging_time[0]))
        parts[type(term)] = parts[type(term)] + part if type(term) in parts else part
    dominant = np.argmax(list(parts.values()), axis=0)
    names = [_NAMES[kind] for kind in parts]
    ends = np.append(np.flatnonzero(np.diff(dominant)), tau.size - 1)
    return ", ".join(f"{names[dominant[end]]} to {seconds_text(float(tau[end]))}" for end in ends)


def _long_enough(coefficients: Mapping[str, Coefficient], duration: float) -> str | None:
    """Return the length of a record that would show a random walk as large as K's limit; None if this record is long enough.

    A random walk shows when its Allan variance at a tenth of the record, K² T/30, exceeds that of the other terms there.
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
    return f"{needed / size:.0f} {unit}"

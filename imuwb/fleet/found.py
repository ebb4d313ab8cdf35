"""The rows that the result of an analysis becomes: a row for each coefficient of each finding, and for each outage of each filter."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from imuwb.analysis import SUSPICIOUS as DOUBT
from imuwb.analysis import Answer, Finding, offers
from imuwb.fleet.schemas import SOUND, SUSPICIOUS
from imuwb.log import ImuStream, Log
from imuwb.statistics import Coefficient, Estimate
from imuwb.texts import printable
from imuwb.units import SECOND, coefficient_units, si_unit, unit

Row = dict[str, Any]


def log_row(log: Log) -> Row:
    """Return what the table of logs has of a log, apart from its place and its owner."""
    imu = next((imu for imu in log.imus if imu.axes()), None)
    return {
        "log": log.provenance.hash,
        "format": log.provenance.format,
        "imu": None if imu is None else printable(imu.name),
        "rate": None if imu is None else _rate(imu),
        "streams": len(log.imus) + len(log.gnss) + len(log.speeds) + len(log.references),
        **_when(imu),
    }


def sensor_rows(name: str, plugin: Any, parameters: object, result: object, log: Log) -> Iterator[Row]:  # noqa: ANN401 - an analysis
    """Yield the coefficients that an analysis finds; if it has no findings, the numbers of its answer.

    Args:
        name: of the analysis, with its method.
        plugin: the analysis.
        parameters: of the analysis; their ``level`` is that of the intervals.
        result: of the analysis.
        log: that was analysed.
    """
    imu = next((imu for imu in log.imus if imu.axes()), None)
    common = {
        "analysis": name,
        "stream": "" if imu is None else printable(imu.name),
        "level": getattr(parameters, "level", None),
        "log": log.provenance.hash,
        **_when(imu),
    }
    findings: Sequence[Finding] = plugin.findings(result) if offers(plugin, "findings") else ()
    for finding in findings:
        for letter, coefficient in finding.coefficients.items():
            yield {**common, **_of_finding(finding), **_of_coefficient(finding.axis, letter, coefficient)}
    if not any(finding.coefficients for finding in findings) and offers(plugin, "answer"):
        answer: Answer = plugin.answer(result)
        for figure, estimate in answer.numbers.items():
            yield {**common, **_of_number(figure, estimate, name), "verdict": SOUND, "remarks": ""}


def outage_rows(name: str, plugin: Any, result: object, log: Log) -> Iterator[Row]:  # noqa: ANN401 - an analysis
    """Yield the errors of each filter in each outage, if the analysis has outages."""
    if not offers(plugin, "drifts"):
        return
    imu = next((imu for imu in log.imus if imu.axes()), None)
    common = {"analysis": name, "log": log.provenance.hash, **_when(imu)}
    for drift in plugin.drifts(result):
        numbers = {key: _finite(value) if isinstance(value, float) else value for key, value in asdict(drift).items()}
        yield {**common, **numbers, "filter": printable(drift.filter), "name": printable(drift.name)}


def _of_finding(finding: Finding) -> Row:
    doubtful = any(remark.startswith(DOUBT) for remark in finding.remarks)
    return {
        "axis": finding.axis,
        "estimator": finding.source,
        "headline": finding.headline,
        "verdict": SUSPICIOUS if doubtful else SOUND,
        "remarks": printable("; ".join(finding.remarks)),
    }


def _of_coefficient(axis: str, letter: str, coefficient: Coefficient) -> Row:
    try:
        si = coefficient_units(axis, letter)[0].name
    except KeyError:  # of another kind than those of noise
        si = si_unit(unit(coefficient.unit or "1").dimension)
    own = coefficient.to(si) if coefficient.unit else coefficient
    known = own.value is not None and math.isfinite(own.value)
    lower = own.lower if known else None
    return {
        "coefficient": letter, "value": own.value if known else None, "lower": _finite(lower), "upper": _finite(own.upper), "unit": si,
    }  # fmt: skip


def _of_number(figure: str, estimate: Estimate, analysis: str) -> Row:
    si = si_unit(unit(estimate.unit or "1").dimension)
    own = estimate.to(si) if estimate.unit else estimate
    return {
        "axis": "", "coefficient": printable(figure), "value": _finite(own.value), "lower": _finite(own.lower),
        "upper": _finite(own.upper), "unit": si, "estimator": analysis, "headline": True,
    }  # fmt: skip


def _when(imu: ImuStream | None) -> Row:
    """Return temperature, duration and start of the IMU; of a log without one, none of them."""
    triads = (
        []
        if imu is None
        else [triad for triad in (imu.angular_rate, imu.specific_force) if triad is not None and len(triad)]
    )
    if imu is None or not triads:
        return {"temperature": None, "duration": None, "start": None}
    first, last = min(int(t.time[0]) for t in triads), max(int(t.time[-1]) for t in triads)
    warm = imu.temperature
    mean = None if warm is None or not len(warm) else _finite(float(np.mean(warm.value)))
    return {
        "temperature": mean,
        "duration": (last - first) / SECOND,
        "start": first if imu.origin.epoch == "unix" else None,
    }


def _rate(imu: ImuStream) -> float | None:
    from imuwb.sampling import sampling  # noqa: PLC0415 - it is compiled

    triad = imu.angular_rate or imu.specific_force
    return None if triad is None else sampling(triad.time).rate


def _finite(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else float(value)

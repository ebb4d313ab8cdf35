"""What a likelihood and the wavelet variances say of the record whose Allan deviation was fitted."""

from __future__ import annotations

from typing import TYPE_CHECKING

from imuwb.identification import (
    burg,
    choose_model,
    fit_cosine_spectrum,
    fit_wavelet_variance,
    spectrum_without,
    stationarity,
    wavelet_variance,
)
from imuwb.statistics import Coefficient
from imuwb.stochastic import Autoregressive, Sinusoid, Sum
from imuwb.units import coefficient_units
from imuwb_plugins.allan.result import Estimates

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from imuwb.identification import CosineSpectrum, Line, ModelChoice, Stationarity
    from imuwb.log import Floats
    from imuwb.statistics import Coefficient
    from imuwb_plugins.allan.parameters import Parameters

AR_ORDERS = (1, 3)  #: of the papers


def estimates(
    axis: str,
    values: Floats,
    dt: float,
    lines: Sequence[Line],
    by_allan: Mapping[str, Coefficient],
    parameters: Parameters,
    band: float,
) -> Estimates:
    """Return the estimates of an evenly spaced record without gaps, beside those of the Allan fit."""
    notes: list[str] = []
    by = {"allan": _results(axis, by_allan)}
    processes: Sum | None = None
    highest: float | None = None
    spectrum: CosineSpectrum | None = None
    try:
        spectrum = spectrum_without(values, dt, lines)
        likely = fit_cosine_spectrum(spectrum, level=parameters.level, highest=band)
        by["likelihood"] = _results(axis, likely.coefficients)
        sinusoids: list[Sinusoid] = [line.process(dt) for line in lines]
        processes, highest = Sum((*likely.identified.terms, *sinusoids)), likely.highest
    except ValueError as error:
        notes.append(f"no likelihood: {error}")
    try:
        by["wavelet"] = _results(axis, _wavelet(values, dt, lines, parameters.level, band))
    except ValueError as error:
        notes.append(f"no wavelet variance: {error}")
    differences = tuple(_differences(by))
    return Estimates(
        "likelihood" if "likelihood" in by else "allan", by, processes, highest, not differences, differences,
        _steady(values, dt, notes), _choice(values, dt, lines, highest, spectrum, parameters, notes), float(values.mean()), tuple(notes),
    )  # fmt: skip


def _wavelet(values: Floats, dt: float, lines: Sequence[Line], level: float, band: float) -> Mapping[str, Coefficient]:
    if band < 0.5 / dt:
        message = f"conditioning changed what lies above {band:.3g} Hz"
        raise ValueError(message)
    return fit_wavelet_variance(wavelet_variance(values, dt), lines, level=level).coefficients


def _steady(values: Floats, dt: float, notes: list[str]) -> Stationarity | None:
    try:
        return stationarity(values, dt)
    except ValueError as error:
        notes.append(f"no test of stationarity: {error}")
        return None


def _choice(
    values: Floats,
    dt: float,
    lines: Sequence[Line],
    highest: float | None,
    spectrum: CosineSpectrum | None,
    parameters: Parameters,
    notes: list[str],
) -> ModelChoice | None:
    if not parameters.choose:
        return None
    try:
        models = burg(values, max(AR_ORDERS))
        regressions = [Autoregressive(tuple(models.alpha[p]), float(models.variance[p]) ** 0.5, dt) for p in AR_ORDERS]
        return choose_model(values, dt, lines, highest=highest, models=regressions, spectrum=spectrum)
    except ValueError as error:
        notes.append(f"no choice of a sum: {error}")
        return None


def _results(axis: str, coefficients: Mapping[str, Coefficient]) -> dict[str, Coefficient]:
    return {letter: c.in_unit(coefficient_units(axis, letter)[0].name) for letter, c in coefficients.items()}


def _differences(by: dict[str, dict[str, Coefficient]]) -> list[str]:
    """Return the coefficients of which two estimators' intervals do not meet."""
    names = list(by)
    found: list[str] = []
    for i, one in enumerate(names):
        for other in names[i + 1 :]:
            found += [
                f"{letter}: {one} and {other}"
                for letter in by[one].keys() & by[other].keys()
                if _apart(by[one][letter], by[other][letter])
            ]
    return sorted(found)


def _apart(a: Coefficient, b: Coefficient) -> bool:
    return a.upper < (b.lower or 0.0) or b.upper < (a.lower or 0.0)

"""Tables of noise over temperature, those of El-Diasty among them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from imuwb.analysis import Table
from imuwb.texts import coefficient_text, decimals
from imuwb.units import coefficient_units
from imuwb_plugins.temperature.tell import NAMES, told

if TYPE_CHECKING:
    from collections.abc import Sequence

    from imuwb.statistics import Coefficient
    from imuwb.units import Unit
    from imuwb_plugins.temperature.result import AxisResult, FirstOrderResult, Result, Study, TemperatureResult

ORDER = ("N", "B", "K", "Q", "alpha", "bias")


def dependence(result: Result) -> Table:
    """Return what depends on temperature: statistic, distribution, p and decision."""
    rows: list[tuple[str, ...]] = []
    for axis, found in result.axes.items():
        for name in ORDER:
            test = found.dependence.by_coefficient.get(name)
            if test is None or (name == "Q" and test.depends is None):
                continue
            law = found.functions[name]
            rows.append((
                axis, NAMES[name], "—" if test.statistic is None else f"{test.statistic:.4g}",
                "—" if test.critical is None else f"{test.critical:.4g}", test.distribution, told(name, test), law.kind or "not in the model",
            ))  # fmt: skip
    first = next(iter(result.axes.values()))
    caption = (
        f"Statistic of the hypothesis that it is the same at all {len(first.by_temperature)} temperatures, by its likelihoods' slopes there; above the critical "
        f"value it is rejected, which it wrongly is in {100 * first.dependence.size:g} % of sensors where nothing depends on temperature. Each "
        f"line is a test of its own."
    )
    headings = ("axis", "what", "statistic", "critical", "distribution", "decision", "function")
    return Table(f"Does {result.imu} depend on temperature?", headings, tuple(rows), caption, wide=True)


def _by_temperature(
    result: Result, axes: Sequence[str], title: str, columns: Sequence[tuple[str, str, Unit | None]], caption: str
) -> Table:
    """Return a table with a row for each temperature and, for each axis, the cells that ``columns`` name."""
    celsius = sorted({round(p.temperature, 1) for axis in axes for p in result.axes[axis].by_temperature})
    rows: list[tuple[str, ...]] = []
    for t in celsius:
        cells: list[str] = [f"{t:.4g}"]
        for axis in axes:
            point = next((p for p in result.axes[axis].by_temperature if round(p.temperature, 1) == t), None)
            cells += ["—" if point is None else _cell(point, name, unit) for name, _, unit in columns]
        rows.append(tuple(cells))
    heads = [
        f"{heading} {axis[-1]}{f' [{unit.name}]' if unit else ''}" for axis in axes for _, heading, unit in columns
    ]
    return Table(title, ("°C", *heads), tuple(rows), caption)


def _cell(point: TemperatureResult, name: str, unit: Unit | None) -> str:
    if name == "ar1":
        return alpha_text(point.ar1)
    if name == "slope":
        slope = point.slope
        return "—" if slope is None else f"{slope.value:.4f} [{slope.lower:.4f}, {slope.upper:.4f}]"
    found: Coefficient = (
        point.bias if name == "bias" else point.deviation if name == "deviation" else point.coefficients[name]
    )
    if unit is None:
        return "—"
    if name == "bias":
        low, value, high = (unit.from_si(v or 0.0) for v in (found.lower, found.value, found.upper))
        digits = decimals(high - low)
        return f"{value:.{digits}f} [{low:.{digits}f}, {high:.{digits}f}]"
    return coefficient_text(found, unit).removesuffix(f" {unit.name}")


def alpha_text(first: FirstOrderResult) -> str:
    """Return AR(1) with its standard errors."""
    return f"{first.alpha:.5f} ± {first.sigma:.1g} ({first.sigma_if_ar:.1g})"


def random_walk(result: Result, sensor: str, axes: Sequence[str]) -> Table:
    """Return N by temperature, in the paper's units (table 1), and the samples' standard deviation."""
    columns = [
        ("N", "N", coefficient_units(axes[0], "N")[1]),
        ("deviation", "sigma", coefficient_units(axes[0], "rate")[1]),
    ]
    caption = (
        f"Value [{100 * result.level:g} % interval], by likelihood; < is an upper limit. sigma: standard deviation of a sample, a drift with time and "
        f"temperature taken off."
    )
    return _by_temperature(result, axes, f"{sensor}: random walk by temperature (table 1)", columns, caption)


def slopes(result: Result, sensor: str, axes: Sequence[str]) -> Table:
    """Return the free slopes of the Allan curves."""
    caption = (
        "Slope of a free line [interval] in the Allan deviation, at the short averaging times where random walk makes 60 % of the variance; -1/2 is "
        "white noise alone."
    )
    return _by_temperature(result, axes, f"{sensor}: is the slope -1/2?", [("slope", "slope", None)], caption)


def slow(result: Result, sensor: str, axes: Sequence[str]) -> Table:
    """Return B and K by temperature."""
    columns = [(x, x, coefficient_units(axes[0], x)[1]) for x in "BK"]
    caption = f"Value [{100 * result.level:g} % interval]; < is an upper limit: not identified at that temperature."
    return _by_temperature(result, axes, f"{sensor}: B and K by temperature", columns, caption)


def first_order(result: Result, sensor: str, axes: Sequence[str]) -> Table:
    """Return AR(1) by temperature (table 2)."""
    caption = (
        f"{result.convention}. ± standard error by Bartlett's formula, which holds for any series; in brackets √((1 - alpha²)/n), which holds for "
        f"an AR(1) only."
    )
    return _by_temperature(result, axes, f"{sensor}: AR(1) by temperature (table 2)", [("ar1", "alpha", None)], caption)


def bias(result: Result, sensor: str, axes: Sequence[str]) -> Table:
    """Return the bias by temperature."""
    columns = [("bias", "bias", coefficient_units(axes[0], "rate")[1])]
    gravity = axes[0].startswith("accel")
    what = (
        f"Change of the mean from {result.reference:g} °C: at one attitude gravity's part of a mean cannot be told from the bias"
        if gravity
        else "Mean of the still sensor; it holds the earth's rate, up to 15 deg/h"
    )
    caption = (
        f"{what}. [{100 * result.level:g} % interval] of its difference from the mean of all temperatures: what noise, and the bias's walk over that time, "
        "make of it; slow noise that was not identified counts with its limit."
    )
    unit = columns[0][2]
    turn_on = [
        f"{axis} {unit.from_si(s):.3g} {unit.name}" for axis in axes if (s := result.axes[axis].turn_on) is not None
    ]
    if turn_on:
        caption += f" From log to log at one temperature it scatters, beyond noise, by {', '.join(turn_on)}."
    return _by_temperature(result, axes, f"{sensor}: bias by temperature", columns, caption)


def functions(result: Result) -> Table:
    """Return the functions of temperature that go into the model."""
    rows = [
        (axis, NAMES[name], law.kind or "—", law.text if law.limit is None else f"below {_limit(axis, name, law.limit)}", law.how)
        for axis, found in result.axes.items()
        for name in ORDER
        if (law := found.functions.get(name)) is not None
    ]  # fmt: skip
    caption = (
        "Values in SI, T in °C. Cross-validation takes the simplest function that agrees with the set-points, and predicts one left out within a standard error of the best; straight lines between them where none does. Between the set-points of "
        "a model, 5 °C apart at most, it is linear; beyond the outer ones it is held."
    )
    return Table(
        "Functions of temperature", ("axis", "what", "function", "in SI", "how"), tuple(rows), caption, wide=True
    )


def _limit(axis: str, name: str, limit: float) -> str:
    unit = coefficient_units(axis, name)[1]
    return f"{unit.from_si(limit):.3g} {unit.name}"


def candidates(result: Result) -> Table:
    """Return how well each kind of function predicted the set-points that were left out."""
    rows: list[tuple[str, ...]] = []
    for axis, found in result.axes.items():
        for name in ORDER:
            law = found.functions.get(name)
            if law is not None and law.candidates:
                rows.append((axis, NAMES[name], *_errors(found, name)))
    kinds = ("constant", "linear", "arrhenius", "quadratic", "cubic", "piecewise", "spline")
    caption = (
        "Mean square of the error of predicting an inner set-point from the others, over its standard error; about 1 to 2 is as good as can be. * is "
        "taken: the simplest that agrees with the set-points within a standard error of the best; none: straight lines between them."
    )
    return Table("Cross-validation", ("axis", "what", *kinds), tuple(rows), caption, wide=True)


def _errors(found: AxisResult, name: str) -> list[str]:
    law = found.functions[name]
    by_kind = {c.kind: c for c in law.candidates}
    kinds = ("constant", "linear", "arrhenius", "quadratic", "cubic", "piecewise", "spline")
    return [
        "—" if (c := by_kind.get(kind)) is None else f"{c.error:.4g}{' *' if kind == law.kind else ''}"  # type: ignore[call-overload]
        for kind in kinds
    ]


def study(found: Study, axis: str) -> Table:
    """Return AR(1) by temperature and setting (tables 3 to 5)."""
    cases = [c for c in found.cases if axis in c.axes]
    celsius = sorted({round(t, 1) for c in cases for t, _ in c.axes[axis]})
    rows = tuple(
        (
            f"{t:.4g}",
            *(next((alpha_text(f) for at, f in c.axes[axis] if round(at, 1) == t), "—") for c in cases),
        )
        for t in celsius
    )
    headings = ("°C", *(", ".join(f"{k} {v}" for k, v in c.settings.items()) for c in cases))
    caption = f"{found.convention}. ± Bartlett's standard error; in brackets that of a true AR(1), which a filtered series is not."
    return Table(f"{axis}: AR(1) by temperature and setting", headings, rows, caption)

"""Tables of noise over temperature, among them those of El-Diasty."""

from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np

from imuwb.analysis import Table
from imuwb.identification.temperature import KINDS, FirstOrder
from imuwb.statistics import Coefficient
from imuwb.texts import coefficient_text, estimate_text, quantity_text
from imuwb.units import Unit, coefficient_units
from imuwb_plugins.temperature.axis_result import NAMES
from imuwb_plugins.temperature.result import FunctionResult, Result, Study, TemperatureResult

Column: TypeAlias = tuple[str, Callable[[TemperatureResult], str]]  # heading before the axis and unit after it, cell

ORDER = ("N", "B", "K", "Q", "alpha", "bias")


def dependence(result: Result) -> Table:
    """Return the tests of dependence on temperature: statistic, distribution, p value and verdict."""
    rows: list[tuple[str, ...]] = []
    for axis, over in result.axes.items():
        for name in ORDER:
            test = over.dependence.by_coefficient.get(name)
            if test is None or (name == "Q" and test.depends is None):
                continue
            rows.append((
                axis, NAMES[name], quantity_text(test.statistic, "", 4), quantity_text(test.critical, "", 4), test.distribution,
                over.dependence.text[name], over.functions[name].kind or "not in the error model",
            ))  # fmt: skip
    count = len(next(iter(result.axes.values())).by_temperature)
    caption = (
        f"Each row tests the hypothesis that a quantity is the same at all {count} temperatures, by the slopes of the likelihoods. "
        f"A statistic above the critical value rejects it. If nothing depends on temperature, this happens in "
        f"{100 * result.size:g} % of sensors, for each test."
    )
    headings = ("axis", "quantity", "statistic [1]", "critical value [1]", "distribution", "verdict", "function")
    return Table(f"Does {result.imu} depend on temperature?", headings, tuple(rows), caption)


def _by_temperature(result: Result, axes: Sequence[str], title: str, columns: Sequence[Column], caption: str) -> Table:
    """Return a table with a row for each temperature, and each column for each axis."""
    celsius = sorted({round(p.temperature, 1) for axis in axes for p in result.axes[axis].by_temperature})
    rows: list[tuple[str, ...]] = []
    for t in celsius:
        cells: list[str] = [f"{t:.4g}"]
        for axis in axes:
            point = next((p for p in result.axes[axis].by_temperature if round(p.temperature, 1) == t), None)
            cells += ["—" if point is None else cell(point) for _, cell in columns]
        rows.append(tuple(cells))
    headings = [heading.replace("{axis}", axis[-1]) for axis in axes for heading, _ in columns]
    return Table(title, ("temperature [°C]", *headings), tuple(rows), caption)


def _coefficient_column(heading: str, of: Callable[[TemperatureResult], Coefficient], unit: Unit) -> Column:
    def cell(point: TemperatureResult) -> str:
        return coefficient_text(of(point), unit).removesuffix(f" {unit.name}")

    return f"{heading} {{axis}} [{unit.name}]", cell


def alpha_text(first: FirstOrder) -> str:
    """Return AR(1) with both standard errors."""
    return f"{first.alpha:.5f} ± {first.sigma:.1g} ({first.sigma_if_ar:.1g})"


def random_walk(result: Result, sensor: str, axes: Sequence[str]) -> Table:
    """Return N by temperature in the paper's units (table 1), and the standard deviation of the samples."""
    columns: list[Column] = [
        _coefficient_column("N", lambda p: p.coefficients["N"], coefficient_units(axes[0], "N")[1]),
        _coefficient_column("sigma", lambda p: p.deviation, coefficient_units(axes[0], "rate")[1]),
    ]
    caption = (
        f"Value [{100 * result.level:g} % interval], by likelihood; < marks an upper limit. sigma: standard deviation of a sample, "
        "without a drift with time and temperature."
    )
    return _by_temperature(result, axes, f"{sensor}: random walk by temperature (table 1)", columns, caption)


def slopes(result: Result, sensor: str, axes: Sequence[str]) -> Table:
    """Return the free slopes of the Allan curves."""
    columns: list[Column] = [("slope {axis}", lambda p: "—" if p.slope is None else f"{p.slope.value:.4f} [{p.slope.lower:.4f}, {p.slope.upper:.4f}]")]  # fmt: skip
    caption = (
        f"Slope [{100 * result.level:g} % interval] of a free line in the Allan deviation, at the short averaging times at which "
        "random walk is 60 % of the variance; white noise alone has -1/2."
    )
    return _by_temperature(result, axes, f"{sensor}: is the slope -1/2?", columns, caption)


def slow(result: Result, sensor: str, axes: Sequence[str]) -> Table:
    """Return B and K by temperature."""
    columns: list[Column] = [
        _coefficient_column("B", lambda p: p.coefficients["B"], coefficient_units(axes[0], "B")[1]),
        _coefficient_column("K", lambda p: p.coefficients["K"], coefficient_units(axes[0], "K")[1]),
    ]
    caption = (
        f"Value [{100 * result.level:g} % interval]; < marks an upper limit of a coefficient that is not identified."
    )
    return _by_temperature(result, axes, f"{sensor}: B and K by temperature", columns, caption)


def first_order(result: Result, sensor: str, axes: Sequence[str]) -> Table:
    """Return AR(1) by temperature (table 2)."""
    caption = (
        f"{result.convention}. ± standard error by Bartlett's formula, for any series; in brackets √((1 - alpha²)/n), for a true "
        "AR(1) only."
    )
    columns: list[Column] = [("alpha {axis}", lambda p: alpha_text(p.ar1))]
    return _by_temperature(result, axes, f"{sensor}: AR(1) by temperature (table 2)", columns, caption)


def bias(result: Result, sensor: str, axes: Sequence[str]) -> Table:
    """Return the bias by temperature."""
    unit = coefficient_units(axes[0], "rate")[1]
    gravity = axes[0].startswith("accel")
    what = (
        f"Change of the mean from {result.reference:g} °C: one attitude does not separate the bias from gravity"
        if gravity
        else "Mean of the still sensor, including the earth's rate, up to 15 deg/h"
    )
    caption = (
        f"{what}. [{100 * result.level:g} % interval] of its difference from the mean of all temperatures, including noise and the "
        "walk of the bias over that time; slow noise that is not identified counts with its limit."
    )
    turn_on = [
        f"{axis} {unit.from_si(s):.3g} {unit.name}" for axis in axes if (s := result.axes[axis].turn_on) is not None
    ]
    if turn_on:
        caption += f" Standard deviation between logs at one temperature, without noise: {', '.join(turn_on)}."
    columns: list[Column] = [(f"bias {{axis}} [{unit.name}]", lambda p: estimate_text(p.bias, "", unit.factor))]
    return _by_temperature(result, axes, f"{sensor}: bias by temperature", columns, caption)


def lags(result: Result) -> Table:
    """Return the lag of each log's thermometer, and the hysteresis of each axis."""
    rows: list[tuple[str, ...]] = []
    for one in result.lags:
        lag = estimate_text(one.lag, "s") if np.isfinite(one.lag.upper) else "not determined"
        state = "removed" if one.removed else "left in"
        for axis, loop in one.hysteresis.items():
            unit = coefficient_units(axis, "rate")[1]
            rows.append((one.log, lag, state, axis, estimate_text(loop, unit.name, unit.factor)))
        if not one.hysteresis:
            rows.append((one.log, lag, state, "—", "the temperature does not turn"))
    caption = (
        f"[{100 * result.level:g} % interval]. Lag: time constant of first order by which the thermometer lags the sensor; negative: "
        "the sensor lags the thermometer. It is removed where the record shows it. Hysteresis: bias with rising minus bias with "
        "falling temperature over the whole log, at the sensor's own temperature."
    )
    headings = ("log", "lag", "lag is", "axis", "hysteresis")
    return Table("Lag of the thermometer, and hysteresis", headings, tuple(rows), caption)


def polynomials(result: Result, sensor: str, axes: Sequence[str]) -> Table:
    """Return the polynomials of the bias about a reference."""
    unit = coefficient_units(axes[0], "rate")[1]
    known = [(axis, p) for axis in axes if (p := result.axes[axis].polynomial) is not None]
    rows = tuple(
        (
            axis,
            *(estimate_text(f, "", unit.factor) if f.sigma else "0" for f in p.factors),
            *("—",) * (4 - len(p.factors)),
        )
        for axis, p in known
    )
    first = known[0][1]
    caption = (
        f"bias = X0 + X1 d + X2 d² + X3 d³, d = T - {first.reference:.4g} °C, [{100 * result.level:g} % interval]; fitted to the samples of "
        f"{first.log}; a highest order that chance explains is left out. It holds from {first.lowest:.1f} to {first.highest:.1f} °C, and "
        "nowhere else."
    )
    if axes[0].startswith("accel"):
        caption += " X0 is 0: one attitude does not separate the bias from gravity."
    headings = ("axis", *(f"X{k} [{unit.name}{power}]" for k, power in enumerate(("", "/°C", "/°C²", "/°C³"))))
    return Table(f"{sensor}: polynomial of the bias", headings, rows, caption)


def functions(result: Result) -> Table:
    """Return the functions of temperature in the error model."""
    rows = [
        (axis, NAMES[name], law.kind or "—", law.formula if law.limit is None else f"below {_limit(axis, name, law.limit)}", law.reason)
        for axis, over in result.axes.items()
        for name in ORDER
        if (law := over.functions.get(name)) is not None
    ]  # fmt: skip
    caption = (
        "Values in SI, T in °C. Cross-validation takes the simplest function that agrees with the set-points and predicts a left-out "
        "set-point within a standard error of the best; if there is no such function, straight lines between the set-points are "
        "used. The error model is linear between temperatures 5 °C apart at most, and constant outside."
    )
    headings = ("axis", "quantity", "function", "formula or limit", "reason")
    return Table("Functions of temperature", headings, tuple(rows), caption)


def _limit(axis: str, name: str, limit: float) -> str:
    unit = coefficient_units(axis, name)[1]
    return f"{unit.from_si(limit):.3g} {unit.name}"


def candidates(result: Result) -> Table:
    """Return how well each kind of function predicts left-out set-points."""
    rows = tuple(
        (axis, NAMES[name], *_errors(law))
        for axis, over in result.axes.items()
        for name in ORDER
        if (law := over.functions.get(name)) is not None and law.candidates
    )
    caption = (
        "Mean square error of the prediction of an inner set-point from the others, over its standard error; 1 to 2 is about the "
        "least. * marks the function: the simplest that agrees with the set-points, within a standard error of the best. Without "
        "*, the function is straight lines between the set-points."
    )
    return Table("Cross-validation", ("axis", "quantity", *KINDS), rows, caption)


def _errors(law: FunctionResult) -> list[str]:
    by_kind = {c.kind: c.error for c in law.candidates}
    return [f"{by_kind[kind]:.4g}{' *' if kind == law.kind else ''}" if kind in by_kind else "—" for kind in KINDS]


def study(result: Study, axis: str) -> Table:
    """Return AR(1) by temperature and setting (tables 3 to 5)."""
    cases = [c for c in result.cases if axis in c.axes]
    celsius = sorted({round(t, 1) for c in cases for t, _ in c.axes[axis]})
    rows = tuple(
        (f"{t:.4g}", *(next((alpha_text(f) for at, f in c.axes[axis] if round(at, 1) == t), "—") for c in cases))
        for t in celsius
    )
    headings = ("temperature [°C]", *(c.text for c in cases))
    caption = f"{result.convention}. ± Bartlett's standard error; in brackets that of a true AR(1), which a filtered series is not."
    return Table(f"{axis}: AR(1) by temperature and setting", headings, rows, caption)

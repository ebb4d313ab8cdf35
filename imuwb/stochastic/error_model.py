"""The error model of an IMU: for each axis a sum of processes and its deterministic terms.

It is a TOML document that people read, edit and keep under version control. A parameter is a number
in SI, a text with its unit (``"2.42 deg/√h"``), or a table with its interval.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, field, fields, replace
from typing import TYPE_CHECKING, Any, cast

import tomli_w

from imuwb.errors import UsageError
from imuwb.log import AXES
from imuwb.stochastic.processes import PROCESSES
from imuwb.stochastic.sums import Sum
from imuwb.units import UNITS, coefficient_units, si_unit, unit

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from imuwb.units import Unit

SCHEMA = 1
#: parameter of a process -> coefficient whose unit it has ("rate": that of the sensor itself)
_PARAMETER = {"N": "N", "B": "B", "K": "K", "R": "R", "Q": "Q", "sigma": "rate", "beta0": "rate", "amplitude": "rate"}
_PLAIN = {"Tc": "s", "frequency": "Hz", "dt": "s"}
#: deterministic term of an axis -> dimension of its unit; "sensor": that of the axis
_TERMS = {
    "scale_factor": "dimensionless", "scale_factor_nonlinear": "dimensionless", "bandwidth": "frequency",
    "group_delay": "time", "lsb": "sensor", "range": "sensor",
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class AxisModel:
    """One sensor axis."""

    processes: Sum = field(default_factory=Sum)
    intervals: Mapping[str, tuple[float, float]] = field(default_factory=dict[str, tuple[float, float]])
    #: parameter, such as "N" -> (lower, upper); a term that was looked for and not found has (0, upper)
    thermal: tuple[tuple[float, Sum], ...] = ()  #: (°C, the same processes at that temperature), rising
    scale_factor: float = 0.0  #: measured = (1 + s) true
    scale_factor_nonlinear: float = 0.0  #: s2 in s2 |true|, as a fraction of the true value at full range
    cross_coupling: tuple[float, float] = (0.0, 0.0)  #: rad, to the two other axes in the order x, y, z
    g_sensitivity: tuple[float, float, float] = (0.0, 0.0, 0.0)  #: rad/s per m/s²; gyros only
    bandwidth: float | None = None  #: Hz, -3 dB
    group_delay: float | None = None  #: s
    lsb: float | None = None  #: smallest step of the output
    range: float | None = None  #: largest output

    def at(self, celsius: float | None) -> Sum:
        """Return the processes at a temperature: parameters linear between set-points, held beyond them."""
        if celsius is None or not self.thermal:
            return self.processes
        below = [point for point in self.thermal if point[0] <= celsius]
        above = [point for point in self.thermal if point[0] >= celsius]
        (t0, low), (t1, high) = (below or above)[-1 if below else 0], (above or below)[0 if above else -1]
        share = 0.0 if t1 == t0 else (celsius - t0) / (t1 - t0)
        return Sum(tuple(_between(a, b, share) for a, b in zip(low.terms, high.terms, strict=True)))


def _between(a: object, b: object, share: float) -> Any:  # noqa: ANN401 - whatever process it is given
    numbers = {
        f.name: (1 - share) * getattr(a, f.name) + share * getattr(b, f.name)
        for f in fields(cast("Any", a))
        if isinstance(getattr(a, f.name), float)
    }
    return replace(cast("Any", a), **numbers)


@dataclass(frozen=True, slots=True)
class ImuErrorModel:
    """Six axes, ``gyro_x`` ... ``accel_z``, and where their figures come from."""

    name: str
    axes: Mapping[str, AxisModel]
    provenance: Mapping[str, str] = field(default_factory=dict[str, str])

    def __post_init__(self) -> None:
        """Check the names of the axes."""
        for axis in self.axes:
            if axis not in AXES:
                message = f"error model {self.name!r}: no axis {axis!r}; there are {', '.join(AXES)}"
                raise UsageError(message)

    def to_toml(self) -> str:
        """Return the model as text."""
        document: dict[str, object] = {"schema": SCHEMA, "name": self.name}
        if self.provenance:
            document["provenance"] = dict(self.provenance)
        for name in AXES:
            if name in self.axes:
                document[name] = _axis_to_toml(name, self.axes[name])
        return tomli_w.dumps(document)

    @staticmethod
    def from_toml(text: str, where: str = "error model") -> ImuErrorModel:
        """Return the model that a text describes.

        Raises:
            UsageError: not TOML, an unknown key, unit or process; the message says which and where.
        """
        try:
            document = tomllib.loads(text)
        except tomllib.TOMLDecodeError as error:
            message = f"{where}: not TOML: {error}"
            raise UsageError(message) from error
        schema = document.pop("schema", SCHEMA)
        if schema != SCHEMA:
            message = f"{where}: written for schema {schema}; this imuwb reads schema {SCHEMA}"
            raise UsageError(message)
        name, provenance = str(document.pop("name", "unnamed")), document.pop("provenance", {})
        axes = {axis: _axis_from_toml(axis, table, f"{where}, {axis}") for axis, table in document.items()}
        return ImuErrorModel(name, axes, provenance)

    @staticmethod
    def read(path: Path) -> ImuErrorModel:
        """Return the model in a file."""
        try:
            return ImuErrorModel.from_toml(path.read_text("utf-8"), str(path))
        except (OSError, UnicodeDecodeError) as error:
            message = f"{path}: cannot be read as an error model: {error}"
            raise UsageError(message) from error


def _parameter_unit(axis: str, parameter: str) -> Unit:
    if parameter in _PLAIN:
        return UNITS[_PLAIN[parameter]]
    return coefficient_units(axis, _PARAMETER[parameter])[0]


def _axis_to_toml(axis: str, model: AxisModel) -> dict[str, object]:
    table: dict[str, object] = {}
    for name in _TERMS:
        value = getattr(model, name)
        if value:
            table[name] = f"{value!r} {_term_unit(axis, name).name}"
    for name in ("cross_coupling", "g_sensitivity"):
        if any(getattr(model, name)):
            table[name] = list(getattr(model, name))
    table["processes"] = _sum_to_toml(axis, model.processes, model.intervals)
    limits = {name: pair for name, pair in model.intervals.items() if name not in _names(model.processes)}
    if limits:
        table["not_identified"] = {
            name: {"upper": pair[1], "unit": _parameter_unit(axis, name).name} for name, pair in limits.items()
        }
    if model.thermal:
        table["thermal"] = [{"celsius": t, "processes": _sum_to_toml(axis, s, {})} for t, s in model.thermal]
    return table


def _names(processes: Sum) -> set[str]:
    return {f.name for term in processes.terms for f in fields(cast("Any", term))}


def _sum_to_toml(axis: str, processes: Sum, intervals: Mapping[str, tuple[float, float]]) -> list[dict[str, object]]:
    rows: list[dict[str, object]] = []
    for term in processes.terms:
        row: dict[str, object] = {"process": cast("Any", term).name}
        for f in fields(cast("Any", term)):
            value = getattr(term, f.name)
            if f.name == "alpha":
                row["alpha"] = list(value)
                continue
            entry: dict[str, object] = {"value": value, "unit": _parameter_unit(axis, f.name).name}
            if f.name in intervals:
                entry["lower"], entry["upper"] = intervals[f.name]
            row[f.name] = entry
        rows.append(row)
    return rows


def _term_unit(axis: str, term: str) -> Unit:
    dimension = _TERMS[term]
    return coefficient_units(axis, "rate")[0] if dimension == "sensor" else UNITS[si_unit(dimension)]


def _axis_from_toml(axis: str, table: object, where: str) -> AxisModel:
    if axis not in AXES or not isinstance(table, dict):
        message = f"{where}: unknown key; a model has name, provenance and the axes {', '.join(AXES)}"
        raise UsageError(message)
    rest = dict(cast("dict[str, Any]", table))
    intervals: dict[str, tuple[float, float]] = {}
    processes = _sum_from_toml(axis, rest.pop("processes", []), where, intervals)
    for name, entry in rest.pop("not_identified", {}).items():
        if not isinstance(entry, dict) or name not in _PARAMETER:
            message = f"{where}: not_identified.{name} must be a table with an upper limit"
            raise UsageError(message)
        fields_of = cast("dict[str, Any]", entry)
        intervals[name] = (0.0, _si({"value": fields_of.get("upper"), "unit": fields_of.get("unit")}, _parameter_unit(axis, name), f"{where}.{name}"))  # fmt: skip
    thermal = tuple(
        (float(point["celsius"]), _sum_from_toml(axis, point["processes"], f"{where}, {point['celsius']} °C", {}))
        for point in rest.pop("thermal", [])
    )
    terms: dict[str, Any] = {}
    for name, value in rest.items():
        if name in _TERMS:
            terms[name] = _si(value, _term_unit(axis, name), f"{where}.{name}")
        elif name in ("cross_coupling", "g_sensitivity"):
            terms[name] = tuple(float(x) for x in value)
        else:
            known = ", ".join((*_TERMS, "cross_coupling", "g_sensitivity", "processes", "not_identified", "thermal"))
            message = f"{where}: unknown term {name!r}; there are {known}"
            raise UsageError(message)
    return AxisModel(processes, intervals, thermal, **terms)


def _sum_from_toml(axis: str, rows: object, where: str, intervals: dict[str, tuple[float, float]]) -> Sum:
    terms: list[Any] = []
    for row in cast("list[dict[str, Any]]", rows):
        name = row.get("process")
        if name not in PROCESSES:
            message = f"{where}: unknown process {name!r}; there are {', '.join(PROCESSES)}"
            raise UsageError(message)
        kind = PROCESSES[name]
        values: dict[str, Any] = {}
        for f in fields(kind):
            if f.name not in row:
                message = f"{where}: {name} needs {f.name}"
                raise UsageError(message)
            entry = row[f.name]
            if f.name == "alpha":
                values["alpha"] = tuple(float(a) for a in entry)
                continue
            si = _parameter_unit(axis, f.name)
            values[f.name] = _si(entry, si, f"{where}, {name}.{f.name}")
            if isinstance(entry, dict) and {"lower", "upper"} <= entry.keys():
                ends = cast("dict[str, Any]", entry)
                low, high = (
                    _si({**ends, "value": ends[end]}, si, f"{where}, {name}.{f.name}") for end in ("lower", "upper")
                )
                intervals[f.name] = (low, high)
        unknown = set(row) - {"process", *(f.name for f in fields(kind))}
        if unknown:
            message = f"{where}: {name} has no {min(unknown)!r}; it has {', '.join(f.name for f in fields(kind))}"
            raise UsageError(message)
        try:
            terms.append(kind(**values))
        except ValueError as error:
            message = f"{where}: {error}"
            raise UsageError(message) from error
    return Sum(tuple(terms))


def _si(entry: object, si: Unit, where: str) -> float:
    """Return a parameter in SI, given as a number, a text with its unit, or a table."""
    if isinstance(entry, int | float):
        return float(entry)
    if isinstance(entry, str):
        number, _, name = entry.strip().partition(" ")
        entry = {"value": number, "unit": name or si.name}
    if isinstance(entry, dict):
        table = cast("dict[str, Any]", entry)
        try:
            value, given = float(table["value"]), unit(str(table.get("unit") or si.name))
        except (KeyError, TypeError, ValueError) as error:
            message = f"{where}: {entry!r} is no number with a unit"
            raise UsageError(message) from error
        if given.dimension != si.dimension:
            message = f"{where}: {given.name!r} is a unit of {given.dimension}; it must be one of {si.dimension}, such as {si.name}"
            raise UsageError(message)
        return given.to_si(value)
    message = f"{where}: {entry!r} is neither a number, a text with a unit nor a table"
    raise UsageError(message)

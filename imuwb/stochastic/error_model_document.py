"""An error model as a TOML document that people read, edit and keep under version control.

A parameter is a number in SI, a text with its unit (``"2.42 deg/√h"``), or a table with its interval.
"""

from collections.abc import Collection, Mapping
from dataclasses import fields
from typing import Any, cast

import tomli_w

from imuwb import documents
from imuwb.documents import refuse, rows, shown, table, words
from imuwb.errors import UsageError
from imuwb.log import AXES
from imuwb.stochastic.autoregressive import Autoregressive
from imuwb.stochastic.axis_model import AxisModel
from imuwb.stochastic.description import LETTERS, PLAIN
from imuwb.stochastic.elementary import LARGEST
from imuwb.stochastic.flicker import FlickerNoise
from imuwb.stochastic.gauss_markov import GaussMarkov
from imuwb.stochastic.processes import Constant, Quantization, RandomWalk, RateRamp, Sinusoid, WhiteNoise
from imuwb.stochastic.sums import Sum
from imuwb.texts import printable, sentence_of
from imuwb.units import UNITS, Unit, coefficient_units, si_unit, unit

SCHEMA = 1
_KINDS = (WhiteNoise, Quantization, FlickerNoise, RandomWalk, RateRamp, GaussMarkov, Autoregressive, Sinusoid, Constant)
PROCESSES = {kind.name: kind for kind in _KINDS}
#: parameters of processes that may have a limit
LIMITED = (*LETTERS, "sigma", "beta0", "amplitude")
#: deterministic term of an axis -> dimension of its unit; "sensor": that of the axis
TERMS = {
    "scale_factor": "dimensionless", "scale_factor_nonlinear": "dimensionless", "bandwidth": "frequency",
    "group_delay": "time", "lsb": "sensor", "range": "sensor", "bias": "sensor",
}  # fmt: skip
#: a term's values by temperature -> the term
CURVES = {"thermal_bias": "bias", "thermal_scale_factor": "scale_factor"}
VECTORS = {"cross_coupling": 2, "g_sensitivity": 3}


def _unit_of(axis: str, name: str) -> Unit:
    """Return the SI unit of a process's parameter or of a deterministic term."""
    if name in PLAIN:
        return UNITS[PLAIN[name]]
    dimension = TERMS.get(name)
    if dimension is not None and dimension != "sensor":
        return UNITS[si_unit(dimension)]
    return coefficient_units(axis, name if name in LETTERS else "rate")[0]


# Writing


def written(
    name: str, axes: Mapping[str, AxisModel], provenance: Mapping[str, str], doubts: tuple[str, ...] = ()
) -> str:
    """Return an error model as text."""
    document: dict[str, object] = {"schema": SCHEMA, "name": printable(name)}
    if doubts:
        document["doubts"] = [printable(doubt) for doubt in doubts]
    if provenance:
        document["provenance"] = {printable(key): printable(text) for key, text in provenance.items()}
    document |= {axis: _axis_table(axis, axes[axis]) for axis in AXES if axis in axes}
    return tomli_w.dumps(document)


def _axis_table(axis: str, model: AxisModel) -> dict[str, object]:
    stated: dict[str, object] = {
        name: f"{float(value)!r} {_unit_of(axis, name).name}" for name in TERMS if (value := getattr(model, name))
    }
    stated |= {name: list(getattr(model, name)) for name in VECTORS if any(getattr(model, name))}
    for name, term in CURVES.items():
        if points := getattr(model, name):
            stated[name] = [
                {"celsius": t, "value": f"{float(value)!r} {_unit_of(axis, term).name}"} for t, value in points
            ]
    stated["processes"] = _process_rows(axis, model.processes, model.intervals)
    if model.limits:
        stated["not_identified"] = {
            name: {"upper": limit, "unit": _unit_of(axis, name).name} for name, limit in model.limits.items()
        }
    if model.autoregressive:
        stated["autoregressive"] = _process_rows(axis, Sum(model.autoregressive), {})
    if model.thermal:
        stated["thermal"] = [{"celsius": t, "processes": _process_rows(axis, s, {})} for t, s in model.thermal]
    return stated


def _process_rows(axis: str, processes: Sum, intervals: Mapping[str, tuple[float, float]]) -> list[dict[str, object]]:
    found: list[dict[str, object]] = []
    for i, term in enumerate(cast("tuple[Any, ...]", processes.terms)):
        row: dict[str, object] = {"process": term.name}
        for f in fields(term):
            value = getattr(term, f.name)
            if f.name == "alpha":
                row["alpha"] = list(value)
                continue
            entry: dict[str, object] = {"value": value, "unit": _unit_of(axis, f.name).name}
            if (ends := intervals.get(f"{i}.{f.name}")) is not None:
                entry["lower"], entry["upper"] = ends
            row[f.name] = entry
        found.append(row)
    return found


# Reading: each value is taken out of a table by a function that checks its type.


def parsed(text: str, where: str) -> tuple[str, dict[str, AxisModel], dict[str, str], tuple[str, ...]]:
    """Return name, axes, provenance and doubts of the error model that a text describes.

    Raises:
        UsageError: the text is no error model; the message states the place and the rule.
    """
    return model_of(documents.parsed(text, where), where)


def is_data_sheet(document: Mapping[str, object]) -> bool:
    """Return whether a TOML document has the form of a data sheet, not that of an error model."""
    tables = [content for key, content in document.items() if key in ("gyro", "accel", *AXES)]
    return (
        bool(tables) and "schema" not in document and all(isinstance(t, dict) and "processes" not in t for t in tables)
    )


def model_of(
    document: dict[str, object], where: str
) -> tuple[str, dict[str, AxisModel], dict[str, str], tuple[str, ...]]:
    """Return what ``parsed`` returns, of a document that is read already; its keys are taken out."""
    if {"gyro", "accel"} & document.keys() and is_data_sheet(document):
        raise UsageError(
            f"{where}: the numbers of a data sheet, not an error model; imuwb model import {where} -o MODEL.toml makes one of them"
        )
    if "filter" in document and "error_model" in document:
        raise UsageError(f"{where}: a filter that a replay saved, not an error model; a replay reads it with --filter")
    schema = document.pop("schema", SCHEMA)
    if schema != SCHEMA:
        raise UsageError(
            f"{where}: the schema number is {shown(schema)}; this imuwb reads schema {SCHEMA}; update imuwb"
        )
    name = sentence_of(words(document.pop("name", "unnamed"), f"{where}, name"))
    provenance = {
        sentence_of(k): sentence_of(v if isinstance(v, str) else shown(v))
        for k, v in table(document.pop("provenance", {}), f"{where}, provenance").items()
    }
    doubts = tuple(
        sentence_of(words(doubt, f"{where}, doubts")) for doubt in rows(document.pop("doubts", []), f"{where}, doubts")
    )
    for axis in document:
        if axis not in AXES:
            raise UsageError(
                f"{where}: unknown key {axis!r}; a model has name, provenance, doubts and the axes {', '.join(AXES)}"
            )
    if not document:
        raise UsageError(f"{where}: it has no axis; an error model has at least one of {', '.join(AXES)}")
    axes = {
        axis: _axis(axis, table(content, f"{where}, {axis}"), f"{where}, {axis}") for axis, content in document.items()
    }
    return name, axes, provenance, doubts


def _axis(axis: str, stated: dict[str, object], where: str) -> AxisModel:
    intervals: dict[str, tuple[float, float]] = {}
    limits: dict[str, float] = {}
    thermal: list[tuple[float, Sum]] = []
    terms: dict[str, Any] = {}
    processes = Sum()
    for key, content in stated.items():
        place = f"{where}.{key}"
        if key == "processes":
            processes = _sum(axis, content, place, intervals)
        elif key == "not_identified":
            limits = _limits(axis, content, place)
        elif key == "autoregressive":
            terms[key] = _sum(axis, content, place, {}, (Autoregressive.name,)).terms
        elif key == "thermal":
            thermal = [_set_point(axis, row, place) for row in rows(content, place)]
        elif key in CURVES:
            terms[key] = tuple(_point(axis, CURVES[key], row, place) for row in rows(content, place))
        elif key in TERMS:
            terms[key] = _si(content, _unit_of(axis, key), place)
        elif key in VECTORS:
            numbers = tuple(_number(x, place) for x in rows(content, place))
            if len(numbers) != VECTORS[key]:
                refuse(place, content, f"{VECTORS[key]} numbers")
            terms[key] = numbers
        else:
            known = ", ".join((*TERMS, *VECTORS, *CURVES, "processes", "not_identified", "autoregressive", "thermal"))
            refuse(where, key, f"one of {known}")
    return _made(
        AxisModel, where, processes=processes, intervals=intervals, limits=limits, thermal=tuple(thermal), **terms
    )


def _set_point(axis: str, row: object, where: str) -> tuple[float, Sum]:
    point = table(row, where)
    celsius = _number(point.get("celsius"), f"{where}.celsius")
    return celsius, _sum(axis, point.get("processes", []), f"{where} at {celsius} °C", {})


def _point(axis: str, term: str, row: object, where: str) -> tuple[float, float]:
    point = table(row, where)
    if odd := set(point) - {"celsius", "value"}:
        refuse(where, min(odd), "celsius or value")
    celsius = _number(point.get("celsius"), f"{where}.celsius")
    return celsius, _si(point.get("value"), _unit_of(axis, term), f"{where} at {celsius} °C")


def _limits(axis: str, content: object, where: str) -> dict[str, float]:
    limits: dict[str, float] = {}
    for name, entry in table(content, where).items():
        if name not in LIMITED:
            refuse(f"{where}.{name}", name, f"one of {', '.join(LIMITED)}")
        limit = table(entry, f"{where}.{name}")
        limits[name] = _si({**limit, "value": limit.get("upper")}, _unit_of(axis, name), f"{where}.{name}.upper")
    return limits


def _sum(
    axis: str,
    content: object,
    where: str,
    intervals: dict[str, tuple[float, float]],
    allowed: Collection[str] = PROCESSES,
) -> Sum:
    terms: list[Any] = []
    for i, entry in enumerate(rows(content, where)):
        row = table(entry, f"{where}[{i}]")
        name = row.pop("process", None)
        if not isinstance(name, str) or name not in allowed:
            refuse(f"{where}[{i}].process", name, f"one of {', '.join(allowed)}")
        kind = PROCESSES[name]
        wanted = [f.name for f in fields(kind)]
        if set(row) != set(wanted):
            odd = min(set(row) ^ set(wanted))
            refuse(
                f"{where}[{i}]",
                odd,
                f"left out: {name} has {', '.join(wanted)}" if odd in row else f"given: {name} needs {odd}",
            )
        values: dict[str, Any] = {}
        for parameter in wanted:
            place = f"{where}[{i}], {name}.{parameter}"
            if parameter == "alpha":
                values["alpha"] = tuple(_number(a, place) for a in rows(row["alpha"], place))
                continue
            si = _unit_of(axis, parameter)
            values[parameter] = _si(row[parameter], si, place)
            interval = _interval(row[parameter], si, place)
            if interval is not None:
                intervals[f"{i}.{parameter}"] = interval
        terms.append(_made(kind, f"{where}[{i}]", **values))
    return Sum(tuple(terms))


def _interval(entry: object, si: Unit, where: str) -> tuple[float, float] | None:
    if not isinstance(entry, dict) or not {"lower", "upper"} & entry.keys():
        return None
    ends = cast("dict[str, object]", entry)
    lower, upper = (_si({**ends, "value": ends.get(end)}, si, f"{where}.{end}") for end in ("lower", "upper"))
    return lower, upper


def _si(entry: object, si: Unit, where: str) -> float:
    """Return a parameter in SI; it is a number, a text with its unit, or a table."""
    name = si.name
    if isinstance(entry, str):
        text, _, written = entry.strip().partition(" ")
        try:
            entry, name = float(text), written or si.name
        except ValueError:
            refuse(where, entry, "a number and its unit")
    elif isinstance(entry, dict):
        stated = cast("dict[str, object]", entry)
        if odd := set(stated) - {"value", "unit", "lower", "upper"}:
            refuse(where, min(odd), "value, unit, lower or upper")
        entry, name = stated.get("value"), words(stated.get("unit", "") or si.name, f"{where}.unit")
    given = unit(name)
    if given.dimension != si.dimension:
        refuse(where, name, f"a unit of {si.dimension.replace('_', ' ')}, such as {si.name}")
    return given.to_si(_number(entry, where))


def _number(content: object, where: str) -> float:
    return documents.number(content, where, "a number, a text with a unit, or a table with a value", LARGEST)


def _made(kind: Any, where: str, **values: object) -> Any:  # noqa: ANN401 - whatever it makes
    try:
        return kind(**values)
    except ValueError as error:
        raise UsageError(f"{where}: {error}") from error

"""The JSON Schema of an error model, from the tables that read and write the document."""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from imuwb.log import AXES
from imuwb.stochastic.autoregressive import Autoregressive
from imuwb.stochastic.error_model_document import CURVES, LIMITED, PROCESSES, SCHEMA, TERMS, VECTORS

Schema = dict[str, Any]

_NUMBERS: Schema = {"type": "array", "items": {"type": "number"}}
_QUANTITY: Schema = {
    "description": "A number in SI, a text with its unit, or a table with its interval",
    "anyOf": [
        {"type": "number"},
        {"type": "string", "pattern": r"^\s*[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?( \S.*)?\s*$"},
        {
            "type": "object",
            "properties": {"value": {"type": "number"}, "unit": {"type": "string"}, "lower": {"type": "number"}, "upper": {"type": "number"}},
            "required": ["value"],
            "additionalProperties": False,
        },
    ],
}  # fmt: skip


def error_model_schema() -> Schema:
    """Return the schema of an error model's TOML document, read as JSON."""
    quantity = {"$ref": "#/$defs/quantity"}
    processes = {"type": "array", "items": {"$ref": "#/$defs/process"}}
    axis: dict[str, Schema] = {
        **dict.fromkeys(TERMS, quantity),
        **{name: {**_NUMBERS, "minItems": count, "maxItems": count} for name, count in VECTORS.items()},
        **{key: {"type": "array", "items": _object({"celsius": {"type": "number"}, "value": quantity}, all_of=True)} for key in CURVES},
        "processes": processes,
        "not_identified": {
            "type": "object",
            "propertyNames": {"enum": list(LIMITED)},
            "additionalProperties": _object({"upper": {"type": "number"}, "unit": {"type": "string"}}, all_of=False),
        },
        "autoregressive": {"type": "array", "items": _process(Autoregressive)},
        "thermal": {"type": "array", "items": _object({"celsius": {"type": "number"}, "processes": processes}, all_of=True)},
    }  # fmt: skip
    document = {
        "schema": {"const": SCHEMA},
        "name": {"type": "string"},
        "doubts": {"type": "array", "items": {"type": "string"}},
        "provenance": {"type": "object"},
        **{key: {"$ref": "#/$defs/axis"} for key in AXES},
    }
    definitions = {
        "quantity": _QUANTITY,
        "process": {"anyOf": [_process(kind) for kind in PROCESSES.values()]},
        "axis": _object(axis, all_of=False),
    }
    one = {"anyOf": [{"required": [name]} for name in AXES]}
    return {**_object(document, all_of=False), **one, "$defs": definitions}


def _process(kind: Any) -> Schema:  # noqa: ANN401 - a class of processes
    names = [f.name for f in fields(kind)]
    own = {name: _NUMBERS if name == "alpha" else {"$ref": "#/$defs/quantity"} for name in names}
    return _object({"process": {"const": kind.name}, **own}, all_of=True)


def _object(properties: Mapping[str, Schema], *, all_of: bool) -> Schema:
    required: Schema = {"required": list(properties)} if all_of else {}
    return {"type": "object", "properties": dict(properties), **required, "additionalProperties": False}

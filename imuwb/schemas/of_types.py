"""From a type to the JSON Schema of what ``imuwb.review.answers.document.plain`` makes of its values.

A float that is not finite is null; an array is a list; a process has its name; a type that JSON lacks is its text.
"""

import ast
import importlib
import inspect
import sys
import types
import typing
from collections.abc import Collection, Iterable, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import fields, is_dataclass
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, Literal, NotRequired, cast

import numpy as np

from imuwb.stochastic.error_model_document import PROCESSES

Schema = dict[str, Any]

NUMBER: Schema = {"type": ["number", "null"]}
#: a list of numbers, or of such lists
NUMBERS: Schema = {
    "type": "array",
    "items": {"anyOf": [NUMBER, {"type": ["boolean", "string"]}, {"$ref": "#/$defs/numbers"}]},
}
_SIMPLE: dict[object, Schema] = {
    bool: {"type": "boolean"}, int: {"type": "integer"}, float: NUMBER, str: {"type": "string"}, type(None): {"type": "null"},
    Path: {"type": "string"}, Any: {}, object: {},
}  # fmt: skip
PROCESS_MODULES = "imuwb.stochastic"


class Schemas:
    """Schemas of types; those of dataclasses are definitions that others refer to."""

    def __init__(self) -> None:
        """Begin without definitions."""
        self.definitions: dict[str, Schema] = {"numbers": NUMBERS}
        self._names: dict[type, str] = {}

    def of(self, kind: Any) -> Schema:  # noqa: ANN401, C901, PLR0911 - a type; one return for each kind of type
        """Return the schema of a type."""
        if kind in _SIMPLE:
            return _SIMPLE[kind]
        origin, inner = typing.get_origin(kind), typing.get_args(kind)
        if origin in (Annotated, NotRequired):
            return self.of(inner[0])
        if typing.is_typeddict(kind) or (isinstance(kind, type) and is_dataclass(kind)):
            return self._reference(kind)
        if origin is Literal:
            return {"enum": list(inner)}
        if origin in (typing.Union, UnionType):
            return self.any_of(inner)
        if origin is np.ndarray or kind is np.ndarray:
            return {"$ref": "#/$defs/numbers"}
        if origin is tuple and not (len(inner) == 2 and inner[1] is Ellipsis):  # noqa: PLR2004 - a type and the ellipsis
            return {
                "type": "array",
                "prefixItems": [self.of(one) for one in inner],
                "minItems": len(inner),
                "maxItems": len(inner),
            }
        origin = origin or kind
        if isinstance(origin, type) and issubclass(origin, Mapping):
            return self._mapping(inner)
        if (
            isinstance(origin, type)
            and issubclass(origin, Sequence | AbstractSet | Collection)
            and not issubclass(origin, str)
        ):
            return {"type": "array", "items": self.of(inner[0]) if inner else {}}
        if getattr(kind, "_is_protocol", False) and kind.__module__.startswith(PROCESS_MODULES):
            return self.any_of(PROCESSES.values())
        return {"type": "string"}

    def any_of(self, kinds: Iterable[Any]) -> Schema:
        """Return the schema of what has one of several types."""
        found: list[Schema] = []
        for schema in map(self.of, kinds):
            if schema not in found:
                found.append(schema)
        if found in ([NUMBER, {"type": "null"}], [{"type": "null"}, NUMBER]):
            return NUMBER
        return found[0] if len(found) == 1 else {"anyOf": found}

    def _mapping(self, inner: tuple[Any, ...]) -> Schema:
        if not inner:
            return {"type": "object"}
        keys = typing.get_args(inner[0]) if typing.get_origin(inner[0]) is Literal else ()
        return {
            "type": "object",
            "additionalProperties": self.of(inner[1]),
            **({"propertyNames": {"enum": list(keys)}} if keys else {}),
        }

    def _reference(self, kind: type) -> Schema:
        """Return a reference to the definition of a dataclass, which is made if it is new."""
        if kind not in self._names:
            same = sum(name.partition("_")[0] == kind.__name__ for name in self._names.values())
            name = self._names[kind] = f"{kind.__name__}_{same + 1}" if same else kind.__name__
            self.definitions[name] = {}  # a dataclass may contain itself
            self.definitions[name] = self._object(kind)
        return {"$ref": f"#/$defs/{self._names[kind]}"}

    def _object(self, kind: type) -> Schema:
        hints = hints_of(kind)
        if typing.is_typeddict(kind):
            names, required = list(hints), sorted(cast("Any", kind).__required_keys__)
        else:
            names = [f.name for f in fields(cast("Any", kind)) if f.metadata.get("document", True)]
            required = names
        own: dict[str, Schema] = {name: self.of(hints[name]) for name in names}
        process = getattr(kind, "name", None)
        if isinstance(process, str) and not typing.is_typeddict(kind):
            own, required = {"process": {"const": process}, **own}, ["process", *required]
        text = (kind.__doc__ or "").strip().partition("\n")[0]
        return {
            "description": text,
            "type": "object",
            "properties": own,
            "required": sorted(required),
            "additionalProperties": False,
        }


def hints_of(kind: Any) -> dict[str, Any]:  # noqa: ANN401 - a class or a function
    """Return the annotations of a class or a function, also those whose types are imported for type checkers only."""
    known: dict[str, Any] = {}
    for module in {one.__module__ for one in (inspect.getmro(kind) if isinstance(kind, type) else (kind,))}:
        known |= _checked_imports(sys.modules[module])
    return typing.get_type_hints(kind, localns=known, include_extras=True)


def _checked_imports(module: types.ModuleType) -> dict[str, Any]:
    """Return what a module imports below ``if TYPE_CHECKING``."""
    file = getattr(module, "__file__", None)
    if file is None or not file.endswith(".py") or not module.__name__.startswith("imuwb"):
        return {}
    found: dict[str, Any] = {}
    for node in ast.parse(Path(file).read_text("utf-8")).body:
        if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
            for one in node.body:
                if isinstance(one, ast.ImportFrom) and one.module:
                    other = importlib.import_module(one.module)
                    found |= {alias.asname or alias.name: getattr(other, alias.name) for alias in one.names}
    return found

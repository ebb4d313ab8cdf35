"""The types of arguments with which imuwb calls its compiled functions, so that all can be compiled before they are needed.

``signatures.json`` has them, {module:function: [types of the arguments, ...]}. A type is

* a text for a number: "float64";
* ``{"array": [type, dimensions, layout, writable]}``, with numba's letters for layouts;
* ``{"tuple": [types]}`` for a tuple, ``{"module:class": [types]}`` for a named tuple.

``python tests/signatures.py`` writes the file again, after the tests have called all functions.
"""

import json
from collections.abc import Mapping, Sequence
from importlib import import_module, resources
from typing import Any, cast

from numba.core import types

from imuwb.compiled import kernels

NAME = "signatures.json"


def compile_all() -> tuple[int, int]:
    """Compile all functions for all their signatures, or read the code that is kept.

    Returns:
        the number of signatures, and of those that had to be compiled.
    """
    listed = cast("dict[str, list[list[Any]]]", json.loads(resources.files("imuwb").joinpath(NAME).read_text("utf-8")))
    for name in listed:
        import_module(name.partition(":")[0])
    for name, signatures in listed.items():
        for signature in signatures:
            kernels[name].compile(tuple(map(type_of, signature)))
    compiled = [sum(kernels[name].stats.cache_misses.values()) for name in listed]
    return sum(map(len, listed.values())), sum(compiled)


def type_of(text: Any) -> Any:  # noqa: ANN401 - JSON, and a type of numba
    """Return numba's type for a type in the file."""
    if isinstance(text, str):
        return getattr(types, text)
    ((kind, parts),) = cast("Mapping[str, Sequence[Any]]", text).items()
    if kind == "array":
        dtype, dimensions, layout, writable = parts
        return types.Array(getattr(types, dtype), dimensions, layout, readonly=not writable)
    members = list(map(type_of, parts))
    if kind == "tuple":
        return types.BaseTuple.from_types(members)
    module, _, name = kind.partition(":")
    return types.BaseTuple.from_types(members, getattr(import_module(module), name))


def text_of(kind: Any) -> Any:  # noqa: ANN401 - a type of numba, and JSON
    """Return a type as it is in the file; None for a type that callers outside compiled code do not have: a literal."""
    if isinstance(kind, types.Literal):
        return None
    if isinstance(kind, types.Array):
        return {"array": [str(kind.dtype), kind.ndim, kind.layout, kind.mutable]}
    if isinstance(kind, types.BaseTuple):
        owner = getattr(kind, "instance_class", tuple)
        name = "tuple" if owner is tuple else f"{owner.__module__}:{owner.__qualname__}"
        return {name: list(map(text_of, cast("Any", kind)))}
    return str(kind)

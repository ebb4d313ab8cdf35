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
from numba.core.errors import NumbaError

from imuwb.compiled import compiled, kernels

NAME = "signatures.json"


def listed() -> dict[str, list[list[Any]]]:
    """Return the signatures in the file, {module:function: [types of the arguments, ...]}."""
    return json.loads(resources.files("imuwb").joinpath(NAME).read_text("utf-8"))


def compile_all() -> tuple[int, int, tuple[str, ...]]:
    """Compile all functions for all their signatures, or read the code that is kept.

    Returns:
        the number of signatures, the number of compilations, and the functions that are not, or not with these arguments.
    """
    count, failed, found = 0, list[str](), listed()
    for name, signatures in found.items():
        module, _, function = name.partition(":")
        try:
            loaded = import_module(module)
            if name not in kernels:  # its module compiles it late
                compiled()(getattr(loaded, function))
            for signature in signatures:
                kernels[name].compile(tuple(map(type_of, signature)))
                count += 1
        except (ImportError, AttributeError, KeyError, TypeError, NumbaError):  # the list is older than the function
            failed.append(name)
    made = [sum(kernels[name].stats.cache_misses.values()) for name in found if name in kernels]
    return count, sum(made), tuple(failed)


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

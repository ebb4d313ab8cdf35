"""Decides whether a loop over bytes is worth the import of the compiler, which costs half a second."""

import sys
from collections.abc import Callable
from functools import cache
from typing import TypeVar, cast

Function = TypeVar("Function", bound=Callable[..., object])

SMALL = 1 << 19  #: bytes; plain Python reads them in less time than the import takes


def worth_compiling(size: int) -> bool:
    """Return whether work on so many bytes pays for the compiler, or whether the compiler is already imported."""
    return size > SMALL or "numba" in sys.modules


late: dict[str, Callable[..., object]] = {}  #: functions that are compiled at the first need, by ``module:name``


def compiled_late(function: Function) -> Function:
    """Note that ``compiled_loop`` compiles a function, so that ``imuwb warm`` can do so before."""
    late[f"{function.__module__}:{function.__qualname__}"] = function
    return function


def compiled_loop(function: Function) -> Function:
    """Return the compiled form of a loop; the first call imports the compiler."""
    return cast("Function", _compiled(function))


@cache
def _compiled(function: Callable[..., object]) -> Callable[..., object]:
    from imuwb.compiled import compiled  # noqa: PLC0415 - the import that small files avoid

    return compiled()(function)

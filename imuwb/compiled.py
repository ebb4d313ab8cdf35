"""Compiles loops, and decides how long compiled code on disk is valid.

Two private parts of numba are used, so pyproject sets an upper bound for numba:

* ``_cache._cache_file._version`` of a compiled function. numba uses code on disk as long as the file of the function itself is
  unchanged, although the code contains all functions that it calls, which may be in other files. There is no public way to
  add these files to the condition.
* the options ``_nrt`` and ``no_cfunc_wrapper``, which numba documents for its own use. Without them a function counts the
  references of arrays that it only reads.
"""

import hashlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., object])


def compiled(*, reorder: bool = False, arrays: bool = True) -> Callable[[Function], Function]:
    """Return the decorator of a function that is compiled at its first call and kept on disk.

    Args:
        reorder: whether sums may be computed in another order, several terms at a time.
        arrays: whether the function makes arrays. A function that makes none does not count references to arrays, which saves
            about a third of the time in loops of a microsecond, and a quarter of the compiler's time; its products and sums
            are fused.
    """
    options: dict[str, Any] = {"cache": True, "nogil": True, "error_model": "numpy"}
    if reorder:
        options["fastmath"] = {"reassoc", "contract", "nsz"}
    if not arrays:
        options |= {"_nrt": False, "no_cfunc_wrapper": True, "fastmath": {"contract"}}

    def decorate(function: Function) -> Function:
        dispatcher = numba.njit(**options)(function)
        cache_file = getattr(getattr(dispatcher, "_cache", None), "_cache_file", None)
        if cache_file is not None:
            cache_file._version += _fingerprint(Path(function.__code__.co_filename).parent)  # noqa: SLF001 - no public way
        return cast("Function", dispatcher)

    return decorate


@cache
def _fingerprint(folder: Path) -> str:
    """Return a fingerprint of all modules in a folder, and of the options that this module sets."""
    digest = hashlib.sha256(Path(__file__).read_bytes())
    for path in sorted(folder.glob("*.py")):
        digest.update(path.read_bytes())
    return f" {digest.hexdigest()[:16]}"

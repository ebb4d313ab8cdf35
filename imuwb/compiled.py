"""How loops are compiled, and how long the compiled code is believed."""

from __future__ import annotations

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
        reorder: whether sums may be taken in another order, several at a time.
        arrays: whether the function makes arrays. One that does not is not made to count those it is handed, which costs about a
            third of the time in loops of a microsecond, and a quarter of the compiler's; its products and sums are fused.
    """
    options: dict[str, Any] = {"cache": True, "nogil": True, "error_model": "numpy"}
    if reorder:
        options["fastmath"] = {"reassoc", "contract", "nsz"}
    if not arrays:
        options |= {"_nrt": False, "no_cfunc_wrapper": True, "fastmath": {"contract"}}

    def decorate(function: Function) -> Function:
        found = numba.njit(**options)(function)
        # What is kept holds the code of all that a function calls, and is else believed while its own file is the same: after
        # an update the old code of the others would be run.
        kept = getattr(getattr(found, "_cache", None), "_cache_file", None)
        if kept is not None:
            kept._version += _state(Path(function.__code__.co_filename).parent)  # noqa: SLF001 - numba has no door for it
        return cast("Function", found)

    return decorate


@cache
def _state(folder: Path) -> str:
    """Return a fingerprint of the modules that lie beside one another in a folder."""
    digest = hashlib.sha256()
    for path in sorted(folder.glob("*.py")):
        digest.update(path.read_bytes())
    return f" {digest.hexdigest()[:16]}"

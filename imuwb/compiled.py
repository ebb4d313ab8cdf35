"""Compiles loops, and decides how long compiled code on disk is valid: while all modules of its folder are unchanged.

numba itself would use code on disk as long as the file of the function is unchanged, although the code contains all functions
that it calls, which may be in other files.
The options ``_nrt`` and ``no_cfunc_wrapper``, which numba documents for its own use, are used too: without them a function counts the
references of arrays that it only reads. pyproject sets an upper bound for numba.
"""

import hashlib
from collections.abc import Callable
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any, TypeVar, cast

import numba

from imuwb.kept_code import Kept
from imuwb.own_process import without

with without("cffi"):
    import_module("numba.core.typing.cffi_utils")  # it looks for cffi when it is imported

Function = TypeVar("Function", bound=Callable[..., object])
kernels: dict[str, Any] = {}  #: compiled functions of this process by ``module:name``


def compiled(*, reorder: bool = False, arrays: bool = True) -> Callable[[Function], Function]:
    """Return the decorator of a function that is compiled at its first call and kept on disk.

    Args:
        reorder: whether sums may be computed in another order, several terms at a time.
        arrays: whether the function makes arrays. A function that makes none does not count references to arrays, which saves
            about a third of the time in loops of a microsecond, and a quarter of the compiler's time; its products and sums
            are fused.
    """
    options: dict[str, Any] = {"nogil": True, "error_model": "numpy"}
    if reorder:
        options["fastmath"] = {"reassoc", "contract", "nsz"}
    if not arrays:
        options |= {"_nrt": False, "no_cfunc_wrapper": True, "fastmath": {"contract"}}

    def decorate(function: Function) -> Function:
        dispatcher = cast("Any", numba.njit(**options)(function))
        if dispatcher is not function:  # with NUMBA_DISABLE_JIT nothing is compiled
            version = _fingerprint(Path(function.__code__.co_filename).parent)
            dispatcher._cache = Kept(function, version)  # noqa: SLF001 - no public way
            kernels[f"{function.__module__}:{function.__qualname__}"] = dispatcher
        return cast("Function", dispatcher)

    return decorate


@cache
def _fingerprint(folder: Path) -> str:
    """Return a fingerprint of all modules in a folder, and of the options that this module sets."""
    digest = hashlib.sha256(Path(__file__).read_bytes())
    for path in sorted(folder.glob("*.py")):
        digest.update(path.read_bytes())
    return f" {digest.hexdigest()[:16]}"

"""Keeps compiled code on disk: reads it where it is, writes it where that is possible, and does without where it is not.

numba gives up where no folder can be written, and does not read from a folder that it cannot write. Here, code that was compiled
when an image was made is read from a folder that cannot be written; where no folder can be written, each process compiles what
it needs, with a warning; and a file on disk that is damaged is made again.
Private parts of numba are used (``numba.core.caching``); pyproject sets an upper bound for numba.
"""

import hashlib
import pickle
import warnings
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from numba.core import caching, config

DIGEST = hashlib.sha256().digest_size  #: bytes
REMEDY = "set NUMBA_CACHE_DIR to a folder that can be written"
used: set[str] = set()  #: folders that this process has read code from, or written it to
lost: list[str] = []  #: why code could not be kept; a process warns once


class CheckedFile(caching.IndexDataCacheFile):
    """The files of one function, each with a hash of its content: damaged machine code would end the process."""

    def __init__(self, path: str, base: str, stamp: object, version: str) -> None:
        """State where the files are; files of another version are not used."""
        super().__init__(path, base, stamp)
        self._version += version

    def _load_index(self) -> Any:  # noqa: ANN401 - {key: name of the file with the code}
        stamp, overloads = _unpacked(Path(self._index_path)) or (None, {})
        return overloads if stamp == (self._version, self._source_stamp) else {}

    def _save_index(self, overloads: Any) -> None:  # noqa: ANN401 - as above
        self._write(self._index_path, ((self._version, self._source_stamp), overloads))

    def _load_data(self, name: str) -> Any:  # noqa: ANN401 - numba's own
        return _unpacked(Path(self._data_path(name)))

    def _save_data(self, name: str, data: object) -> None:
        self._write(self._data_path(name), data)

    def _write(self, path: str, content: object) -> None:
        packed = self._dump(content)
        with self._open_for_write(path) as file:
            file.write(hashlib.sha256(packed).digest() + packed)


def cost() -> str:
    """Return what it costs that code could not be kept, and what to do."""
    text = f"compiled code cannot be kept ({lost[0]}), so each run compiles what it needs again, which takes up to half a minute"
    return f"{text}; {REMEDY}"


def _unpacked(path: Path) -> Any:  # noqa: ANN401 - any content
    """Return the content of a file; None if there is none, or if it is damaged or of another program."""
    with suppress(Exception):  # what another version of Python or numba has written may raise anything
        content = path.read_bytes()
        if hashlib.sha256(content[DIGEST:]).digest() == content[:DIGEST]:
            return pickle.loads(content[DIGEST:])  # noqa: S301 - as numba does, from the same folders
    return None


def _unchecked(locator: Any) -> Any:  # noqa: ANN401 - a private class of numba
    """Return the locator of the same folder that does not demand that it can be written."""

    def from_function(cls: Any, function: object, file: str) -> object:  # noqa: ANN401 - as above
        return cls(function, file)

    return type(locator.__name__, (locator,), {"from_function": classmethod(from_function)})


class Kept:
    """The compiled code of one function on disk, in the place of ``numba.core.caching.FunctionCache``.

    The folders, in order: the one of NUMBA_CACHE_DIR, ``__pycache__`` beside the module, that of the user.
    """

    def __init__(self, function: Callable[..., object], version: str) -> None:
        """State whose code is kept; code of another version is not used."""
        kinds: list[Any] = [caching.InTreeCacheLocator, caching.UserWideCacheLocator]
        if getattr(config, "CACHE_DIR", ""):
            kinds.insert(0, caching.UserProvidedCacheLocator)
        there = Path(function.__code__.co_filename).is_file()  # not the code of a prompt
        self._caches = [_cache(function, kind, version) for kind in kinds] if there else []

    @property
    def cache_path(self) -> str | None:
        """The first folder."""
        return self._caches[0].cache_path if self._caches else None

    def load_overload(self, signature: Any, target: Any) -> Any:  # noqa: ANN401 - numba's own
        """Return the code for a signature; None: there is none."""
        for cache in self._caches:
            with suppress(Exception):  # as in ``_unpacked``
                if (found := cache.load_overload(signature, target)) is not None:
                    used.add(cache.cache_path)
                    return found
        return None

    def save_overload(self, signature: Any, code: Any) -> None:  # noqa: ANN401 - numba's own
        """Keep the code for a signature in the first folder that can be written; warn if there is none."""
        why = ""
        for cache in self._caches:
            try:
                cache.save_overload(signature, code)
            except OSError as error:
                why = f"{cache.cache_path}: {error.strerror or error}"
                continue
            used.add(cache.cache_path)
            return
        if self._caches and not lost:
            lost.append(why)
            warnings.warn(cost(), stacklevel=2)

    def signatures(self) -> set[Any]:
        """Return the signatures whose code is kept."""
        return {key[0] for cache in self._caches for key in cache._cache_file._load_index()}  # noqa: SLF001 - no public way

    def flush(self) -> None:
        """Forget all code of the function."""
        for cache in self._caches:
            with suppress(OSError):
                cache.flush()


def _cache(function: Callable[..., object], locator: Any, version: str) -> Any:  # noqa: ANN401 - numba's own
    kind = type("Code", (caching.CompileResultCacheImpl,), {"_locator_classes": [_unchecked(locator)]})
    cache: Any = type("Cache", (caching.FunctionCache,), {"_impl_class": kind})(function)
    own = cache._impl  # noqa: SLF001 - no public way
    cache._cache_file = CheckedFile(cache.cache_path, own.filename_base, own.locator.get_source_stamp(), version)  # noqa: SLF001
    return cache

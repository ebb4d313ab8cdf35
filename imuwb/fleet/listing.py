"""The logs that patterns name: paths and globs of this machine, folders, and the same in object stores."""

import glob
import hashlib
import os
import re
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from imuwb.errors import UnreadableLogError, UsageError
from imuwb.fleet.own_files import results_of
from imuwb.fleet.store import attempted, listed, parted
from imuwb.readers.bytes.address import STORES, WEB, Address, is_address, place_of
from imuwb.readers.reading import reader_of

SPECIAL = re.compile(r"[*?[]")
#: suffixes of what imuwb itself writes beside logs
NO_LOGS = (".rrd", ".html", ".pdf", ".json", ".jsonl", ".toml", ".partial", ".md", ".py")
TAG = 16  #: letters of a tag


@dataclass(frozen=True, slots=True)
class Listed:
    """A log that was found, and what its store says of it without reading it."""

    place: str  #: path or address
    size: int  #: bytes; 0: not known
    tag: str  #: of size and time of a file, or of size and tag of an object: another tag means another content, perhaps


def found(patterns: Iterable[str], apart: str = "") -> tuple[Listed, ...]:
    """Return the logs that some patterns name, in the order of their places.

    Args:
        patterns: paths or addresses; ``*``, ``?`` and ``[...]`` stand for letters of a name, ``**`` for folders; a folder stands
            for all files below it. Files that imuwb writes beside logs are left out, unless a pattern ends with their suffix. A file
            that several paths lead to counts once.
        apart: a folder whose files are no logs: that of the results.

    Raises:
        UsageError: a pattern matches nothing, or only files in the folder ``apart``.
        TransportError: a store does not answer.
    """
    logs: dict[str, Listed] = {}
    for pattern in patterns:
        matching = list(_matching(pattern))
        own = [log for log in matching if not (apart and _within(log.place, apart))]
        if matching and not own:
            raise UsageError(
                f"{_shown(pattern)}: all that matches is in {_shown(apart)}, the folder of the results, whose files are no logs; give "
                "another folder with --output"
            )
        if not own:
            hint = "put the pattern in quotes, and check it" if SPECIAL.search(pattern) else "check the path"
            raise UsageError(
                f"{_shown(pattern)}: no log matches; {hint}: ** stands for any folders, * for any letters of a name"
            )
        logs |= {log.place: log for log in own}
    once = {_real(place): place for place in sorted(logs, reverse=True)}
    return tuple(logs[place] for place in sorted(once.values()))


def _real(place: str) -> str:
    """Return one path for a file that several paths lead to, as links do."""
    return place if is_address(place) else os.path.realpath(place)


def logs_in(folder: Path) -> tuple[Path, ...]:
    """Return the logs in a folder, by their names; a folder that is one log of several files is itself the only one.

    Raises:
        UnreadableLogError: the folder has no log.
    """
    with suppress(UnreadableLogError):
        several = getattr(reader_of(folder), "has_several_logs", None)
        if several is None or not several(folder):
            return (folder,)
    files = [file for file in sorted(folder.iterdir()) if file.is_file() and _is_log(file.name) and _can_be_read(file)]
    if not files:
        raise UnreadableLogError(f"{folder}: there is no log in this folder; name the logs, or another folder")
    return tuple(files)


def _can_be_read(file: Path) -> bool:
    try:
        reader_of(file)
    except UnreadableLogError:
        return False
    return True


def tag_of(*parts: object) -> str:
    """Return a short hash of some parts."""
    return hashlib.sha256("\0".join(map(str, parts)).encode("utf-8", "surrogateescape")).hexdigest()[:TAG]


def _matching(pattern: str) -> Iterator[Listed]:
    if not is_address(pattern):
        return _files(pattern)
    if pattern.partition("://")[0].lower() in STORES:
        return _objects(pattern)
    place = place_of(pattern)  # a file:// address is a path
    return _files(str(place)) if isinstance(place, Path) else iter((_web(place),))


def _files(pattern: str) -> Iterator[Listed]:
    path = Path(pattern)
    if path.is_dir():
        files: Iterable[Path] = (Path(at, name) for at, _, names in os.walk(path) for name in names if _is_log(name))
    elif path.exists() or not SPECIAL.search(pattern):
        files = (path,) if path.exists() else ()
    else:
        # Path.glob takes no absolute pattern.
        names = (name for name in glob.iglob(pattern, recursive=True) if _is_log(Path(name).name, pattern))  # noqa: PTH207
        files = (file for name in names if not (file := Path(name)).is_dir())
    for file in files:
        try:
            state = file.stat()
        except OSError:  # it went away meanwhile
            continue
        if file.suffix == ".parquet" and results_of(file) is not None:
            continue
        yield Listed(str(file), state.st_size, tag_of("file", state.st_size, state.st_mtime_ns))


def _is_log(name: str, pattern: str = "") -> bool:
    """Return whether a file may be a log; one that imuwb writes is none, unless a pattern names its suffix."""
    wanted = pattern.endswith(tuple(suffix for suffix in NO_LOGS if name.endswith(suffix)))
    hidden = name.startswith(".") and not pattern.rpartition("/")[2].startswith(".")
    return not hidden and (wanted or not name.endswith(NO_LOGS))


def _objects(pattern: str) -> Iterator[Listed]:
    from imuwb.readers.bytes.stores import store_of  # noqa: PLC0415 - obstore is imported for addresses only

    scheme, bucket, key = parted(pattern)
    special = SPECIAL.search(key)
    prefix = key[: key.rfind("/", 0, special.start()) + 1] if special else key
    address = Address(f"{scheme}://{bucket}/{key}")
    store = store_of(address)[0]
    if not special and key and not key.endswith("/"):
        import obstore  # noqa: PLC0415 - as above

        one = attempted(lambda: _head(obstore, store, key), address)
        if one is not None:
            yield _object(scheme, bucket, one)
            return
        prefix = f"{key}/"
    wanted = re.compile(_expression(key)) if special else None
    for meta in listed(store, address, prefix):
        name = meta["path"]
        if (wanted is None or wanted.fullmatch(name)) and _is_log(name.rpartition("/")[2], key):
            yield _object(scheme, bucket, meta)


def _head(obstore: Any, store: Any, key: str) -> Any:  # noqa: ANN401 - obstore's own types
    try:
        return obstore.head(store, key)
    except FileNotFoundError:
        return None


def _object(scheme: str, bucket: str, meta: Any) -> Listed:  # noqa: ANN401 - obstore's own types
    version = meta["e_tag"] or meta["last_modified"]
    return Listed(f"{scheme}://{bucket}/{meta['path']}", meta["size"], tag_of("object", meta["size"], version))


def _web(address: Address) -> Listed:
    if address.scheme not in WEB or SPECIAL.search(address.key):
        raise UsageError(f"{address}: a web server does not list its files; give the address of each log")
    import obstore  # noqa: PLC0415 - as above

    from imuwb.readers.bytes.stores import store_of  # noqa: PLC0415 - as above

    store, key = store_of(address)
    meta = attempted(lambda: _head(obstore, store, key), address)
    if meta is None:
        return Listed(address.url, 0, tag_of("web", str(address)))
    return Listed(address.url, meta["size"], tag_of("web", meta["size"], meta["e_tag"] or meta["last_modified"]))


def _expression(pattern: str) -> str:
    """Return a glob as a regular expression: ``**/`` any folders, ``*`` and ``?`` letters of a name, ``[...]`` one of some letters."""
    parts = re.split(r"(\*\*/|\*\*|\*|\?|\[[^\]/]+\])", pattern)
    own = {"**/": "(?:[^/]+/)*", "**": ".*", "*": "[^/]*", "?": "[^/]"}
    return "".join(
        own.get(part) or (_letters(part) if part.startswith("[") and part[-1] == "]" else re.escape(part))
        for part in parts
    )


def _letters(part: str) -> str:
    inner = part[1:-1].replace("\\", "\\\\")
    return f"[^{inner[1:]}]" if inner.startswith("!") else f"[{inner}]"


def _within(place: str, folder: str) -> bool:
    if is_address(place) or is_address(folder):
        return place.startswith(folder.rstrip("/") + "/")
    return Path(folder).resolve() in Path(place).resolve().parents


def _shown(pattern: str) -> str:
    return str(Address(pattern)) if is_address(pattern) else pattern

"""Definitions of ROS messages that a log does not hold: those that the user gives, and those that imuwb knows."""

from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

from imuwb import ros
from imuwb.errors import UsageError
from imuwb.readers.containers import ros_idl
from imuwb.readers.containers.ros_layout import sections

SUFFIXES = (".msg", ".idl")
LARGEST = 1 << 20  #: bytes; a larger file defines no message


class Definitions:
    """Where the definition of a type is looked up if the log does not hold it."""

    def __init__(self, path: Path | None = None) -> None:
        """Read the definitions that the user gives.

        Args:
            path: a ``.msg`` or ``.idl`` file, or a folder with such files, ``package/msg/Type.msg`` at any depth.

        Raises:
            UsageError: there is no such file or folder, or it has no definition.
        """
        self._given: dict[str, list[str]] = defaultdict(list)
        if path is not None:
            for name, text in _read(path):
                self._given[name].append(text)

    def whole(self, name: str) -> Iterator[str]:
        """Yield the definitions of a type, those of the user first; nothing for an unknown type."""
        name = ros.short(name)
        yield from self._of(name)
        yield from ros.definitions(name)

    def part(self, name: str) -> str:
        """Return the fields of a type that another type contains; an empty text for an unknown type."""
        return next(self._of(name), ros.definition(name).partition("=" * 80)[0])

    def _of(self, name: str) -> Iterator[str]:
        """Yield what the user gives for a type; a single file may not tell its package."""
        yield from self._given.get(name, ())
        yield from self._given.get(name.rpartition("/")[2], ())


def _read(path: Path) -> Iterator[tuple[str, str]]:
    """Yield (type, definition) of each definition in a file or folder; without its package if the path does not tell it."""
    files = [path] if path.is_file() else sorted(f for f in path.rglob("*") if f.suffix in SUFFIXES and f.is_file())
    if not path.exists():
        raise UsageError(f"messages: there is no file or folder {path}; name a folder with .msg files, or one of them")
    if not files or any(file.suffix not in SUFFIXES for file in files):
        raise UsageError(f"messages: {path} has no .msg or .idl file; name a folder with .msg files, or one of them")
    for file in files:
        if file.stat().st_size > LARGEST:
            continue
        text = file.read_text("utf-8", "replace")
        if file.suffix == ".idl":
            yield from ros_idl.converted(text).items()
            continue
        (_, main), *others = sections(file.stem, text)
        yield "/".join((*_package(file), file.stem)), main
        yield from others


def _package(file: Path) -> tuple[str, ...]:
    """Return the package that a file's path tells, ``package/msg/Type.msg``; nothing if it tells none."""
    above = file.resolve().parent
    return (above.parent.name,) if above.name in ("msg", "ros2msg", "ros1msg") else ()

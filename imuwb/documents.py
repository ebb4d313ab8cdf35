"""TOML documents: one reader for all of them, and checks of what is in them. A message names the file, the key, the rule and what is found."""

import math
import reprlib
import tomllib
from pathlib import Path
from typing import NoReturn, cast

from imuwb.errors import UsageError
from imuwb.renames import settle

LARGEST = 16 << 20  #: bytes of a document
DEEPEST = 32  #: tables and lists within each other
_SHOWN = reprlib.Repr()
_SHOWN.maxlevel, _SHOWN.maxstring, _SHOWN.maxother, _SHOWN.maxlong = 3, 80, 80, 40


def shown(content: object) -> str:
    """Return a value as it is written in a message: with its quotes, and not long."""
    return _SHOWN.repr(content)


def refuse(where: str, found: object, expected: str) -> NoReturn:
    """Raise UsageError: ``FILE, KEY is VALUE; it must be EXPECTED``."""
    raise UsageError(f"{where} is {shown(found)}; it must be {expected}")


def document_of(path: str | Path, what: str) -> dict[str, object]:
    """Return the document in a file.

    Args:
        path: the file.
        what: the document, such as ``an error model``.

    Raises:
        UsageError: the file cannot be read, or is not TOML.
    """
    settle(Path(path))
    try:
        with Path(path).open("rb") as file:
            content = file.read(LARGEST + 1)
        text = content.decode("utf-8")
    except OSError as error:
        raise UsageError(f"{path}: cannot be read as {what}: {error.strerror or error}") from error
    except UnicodeDecodeError as error:
        raise UsageError(f"{path}: cannot be read as {what}: it is not UTF-8: {error}") from error
    if len(content) > LARGEST:
        raise UsageError(f"{path}: cannot be read as {what}: it has more than {LARGEST >> 20} MiB")
    return parsed(text, f"{path}: cannot be read as {what}")


def parsed(text: str, where: str) -> dict[str, object]:
    """Return the document that a text is.

    Raises:
        UsageError: the text is not TOML, or nests too deep.
    """
    try:
        document: dict[str, object] = tomllib.loads(text)
    except RecursionError:
        raise UsageError(f"{where}: it nests deeper than {DEEPEST} tables and lists") from None
    except ValueError as error:  # not TOML, or a number of thousands of digits
        raise UsageError(f"{where}: not TOML: {error}") from error
    level: list[object] = [document]
    for _ in range(DEEPEST):
        level = [item for content in level for item in _items(content)]
    if level:
        raise UsageError(f"{where}: it nests deeper than {DEEPEST} tables and lists")
    return document


def _items(content: object) -> list[object]:
    if isinstance(content, dict):
        return list(cast("dict[str, object]", content).values())
    return cast("list[object]", content) if isinstance(content, list) else []


def table(content: object, where: str) -> dict[str, object]:
    """Return a copy of a table; UsageError for another value."""
    if not isinstance(content, dict):
        refuse(where, content, "a table")
    return dict(cast("dict[str, object]", content))


def rows(content: object, where: str) -> list[object]:
    """Return a list; UsageError for another value."""
    if not isinstance(content, list):
        refuse(where, content, "a list")
    return cast("list[object]", content)


def words(content: object, where: str) -> str:
    """Return a text; UsageError for another value."""
    if not isinstance(content, str):
        refuse(where, content, "a text")
    return content


def number(content: object, where: str, expected: str = "a finite number", largest: float = math.inf) -> float:
    """Return a number; UsageError for another value, and for one that is not below ``largest``."""
    if isinstance(content, bool) or not isinstance(content, int | float) or not abs(content) < largest:
        refuse(where, content, expected)
    return float(content)


def numbers(content: object, count: int, where: str) -> tuple[float, ...]:
    """Return so many finite numbers; UsageError for another value."""
    expected = f"{count} finite number{'s' if count > 1 else ''}"
    values = cast("list[object]", content) if isinstance(content, list) else []
    if len(values) != count or any(
        isinstance(x, bool) or not isinstance(x, int | float) or not abs(x) < math.inf for x in values
    ):
        refuse(where, content, expected)
    return tuple(float(cast("float", x)) for x in values)


def whole(content: object, where: str, least: int, most: int) -> int:
    """Return a whole number; UsageError for another value, and for one outside the limits."""
    if isinstance(content, bool) or not isinstance(content, int) or not least <= content <= most:
        refuse(where, content, f"a whole number from {least} to {most}")
    return content

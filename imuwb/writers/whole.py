"""Writes files whole or not at all: each file is written under another name in the same folder, then renamed."""

import os
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

from imuwb.errors import ImuwbError


def partial(path: Path) -> Path:
    """Return the path to which a file is written until it is whole."""
    return path.with_name(f".{path.name}.{os.getpid()}.partial")


@contextmanager
def whole_file(path: str | Path) -> Generator[Path]:
    """Yield a path to write to; after the block the file is at ``path``; after an error it is nowhere.

    Raises:
        ImuwbError: the file cannot be written.
    """
    path = Path(path).resolve()  # a link stays a link, and leads to the new file
    temporary = partial(path)
    try:
        yield temporary
        temporary.replace(path)
    except OSError as error:
        raise ImuwbError(f"{path}: cannot be written: {error.strerror or error}") from error
    finally:
        temporary.unlink(missing_ok=True)


def write_text(path: str | Path, text: str) -> None:
    """Write a text file, whole or not at all; a character that UTF-8 does not have, such as a part of a file's name, is replaced."""
    with whole_file(path) as temporary:
        temporary.write_text(text, "utf-8", "replace")

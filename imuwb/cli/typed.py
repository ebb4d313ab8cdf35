"""Commands as users type them, for those that imuwb shows to be typed next."""

import shlex
import sys
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path
from typing import Any, cast

from imuwb.cli.parameters import default_of
from imuwb.options import text_of
from imuwb.readers.bytes.address import without_secrets

#: options of output files, which a command that is typed again must not overwrite
_FILES = (
    "--output",
    "-o",
    "--json",
    "--html",
    "--pdf",
    "--figures",
    "--tables",
    "--save-model",
    "--save-filter",
    "--save-config",
)


def typed_again(recording: Path) -> str:
    """Return the command that was typed, to be typed again with more options: it writes another recording beside the first."""
    kept: list[str] = []
    words = iter(sys.argv[1:])
    for word in words:
        name, equals, _ = word.partition("=")
        if name in _FILES:
            if not equals:
                next(words, None)
        elif word != "--force":
            kept.append(without_secrets(word))
    return shlex.join(["imuwb", *kept, "-o", str(recording.with_name(f"{recording.stem}-2.rrd"))])


def options_given(*groups: object) -> tuple[str, ...]:
    """Return the options of some dataclasses that differ from their defaults, as words of a command."""
    return tuple(shlex.quote(word) for group in groups for word in _words(group))


def _words(group: object) -> Iterator[str]:
    for f in fields(cast("Any", group)):
        value, flag = getattr(group, f.name), f"--{f.name.replace('_', '-')}"
        if value == default_of(f) or value is None:
            continue
        if isinstance(value, bool):
            yield flag if value else f"--no-{flag[2:]}"
            continue
        for text in map(str, cast("list[object]", value)) if isinstance(value, list) else (text_of(value),):
            yield from (flag, text)

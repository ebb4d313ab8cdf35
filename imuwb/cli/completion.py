"""The words that a shell asks to complete: the line of the shell, and the values that options offer.

A shell asks by running the program without arguments. The environment then contains the line to complete: bash passes
COMP_WORDS and COMP_CWORD, zsh, fish and PowerShell pass _TYPER_COMPLETE_ARGS (``typer._completion_classes``).
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import fields
from pathlib import Path
from typing import Any, cast

import typer

from imuwb.options import Form

ASKED = "_IMUWB_COMPLETE"  #: name of the variable that is in the environment when a shell asks


def words_before(environment: Mapping[str, str]) -> list[str]:
    """Return the words between the program's name and the word that is to be completed."""
    if "COMP_CWORD" in environment:
        return environment.get("COMP_WORDS", "").split()[1 : int(environment["COMP_CWORD"])]
    line = environment.get("_TYPER_COMPLETE_ARGS", "")
    words = line.split()[1:]
    return words if line.endswith(" ") else words[:-1]


def completer(form: Form) -> Callable[[typer.Context, str], list[str]] | None:
    """Return what offers the values of an option to a shell; None if nothing is known of them."""
    if not (form.words or form.streams):
        return None

    def offered(ctx: typer.Context, incomplete: str) -> list[str]:
        words = list(form.words() if callable(form.words) else form.words)
        if form.streams:
            words += _streams_of(ctx, form.streams)
        mark = "," if form.pattern.endswith(",...") and "=" not in form.pattern else ""
        before, mark, _ = incomplete.rpartition(mark) if mark else ("", "", incomplete)
        taken = before.split(",")
        return [f"{before}{mark}{word}" for word in words if word not in taken]

    return offered


def _streams_of(ctx: typer.Context, kind: str) -> list[str]:
    """Return the names of the streams of the log that is given; none of a log that would take long to read."""
    # The option at the end has no value yet, so that the words before it have not become arguments.
    logs = ctx.params.get("logs") or ctx.params.get("log") or ctx.args
    path = Path(logs if isinstance(logs, str) else next(iter(logs), "")).expanduser()
    with suppress(Exception):  # a shell shows no errors
        from imuwb.cli.stream_names import stream_names  # noqa: PLC0415 - it needs the readers

        return stream_names(path, kind)
    return []


def conditioner_words() -> Iterator[str]:
    """Yield NAME: and NAME:key= of the conditioners."""
    for name, keys in _conditioners():
        yield name
        yield from (f"{name}:{key}=" for key in keys)


def study_words() -> Iterator[str]:
    """Yield NAME.key= of the conditioners."""
    for name, keys in _conditioners():
        yield from (f"{name}.{key}=" for key in keys)


def _conditioners() -> Iterator[tuple[str, Iterable[str]]]:
    from imuwb import registry  # noqa: PLC0415 - only a shell asks

    for name, point in registry.installed(registry.CONDITIONERS).items():
        if (conditioner := registry.load(point)) is not None:
            yield name, [f.name for f in fields(cast("Any", conditioner).Parameters)]

"""The manual page of imuwb (``man imuwb``), made from the commands: ``python docs/making/manual.py > imuwb.1``."""

import re
import sys
from collections.abc import Iterator
from importlib.metadata import version
from typing import Any

import typer

from imuwb.cli.app import every_command
from imuwb.cli.help import parted

ALWAYS = ("help", "config", "save_config")  #: options of every command, which are explained once
EXIT_CODES = (
    ("0", "done"),
    ("1", "the work failed, or a limit that was asked for is exceeded"),
    ("2", "the command, an option or a plugin is wrong"),
    ("3", "the log is sound, but lacks what the analysis needs"),
    ("4", "the log cannot be read, or contradicts what its user states"),
)
FILES = (
    ("NAME.rrd", "the recording that an analysis writes; imuwb view opens it"),
    ("NAME.error-model.toml", "the error model of a sensor"),
    ("NAME.toml beside a log", "states how the log is read"),
)
VARIABLES = (
    ("NUMBA_CACHE_DIR", "folder in which compiled code is kept"),
    ("IMUWB_TRACEBACK", "1: a fault shows where in the code it happened"),
)


def manual() -> str:
    """Return the manual page as the macros of man."""
    lines = [
        f'.TH IMUWB 1 "" "imuwb {version("imuwb")}" "User commands"',
        ".SH NAME", r"imuwb \- a workbench for inertial logs: noise identification and GNSS outage replay",
        ".SH SYNOPSIS", ".B imuwb", r".I COMMAND", "[options] [logs]",
        ".SH DESCRIPTION",
        _text(
            "imuwb answers how noisy an inertial sensor is, what is wrong with a log, and how far a vehicle drifts without GNSS. Each command prints "
            "an answer of a few lines, with intervals and units, and writes a recording for the Rerun viewer. Every command has --help."
        ),
        ".SH COMMANDS",
    ]  # fmt: skip
    for name, command in every_command():
        lines += _command(name, command)
    lines += [".SH OPTIONS OF EVERY COMMAND"]
    lines += _item("--config FILE.toml", "Read options from a settings file; the command line beats it.")
    lines += _item("--save-config FILE.toml", "Write all options of this run, so that --config repeats it.")
    lines += _item("-h, --help", "Print the help of a command.")
    for title, rows in (("EXIT STATUS", EXIT_CODES), ("FILES", FILES), ("ENVIRONMENT", VARIABLES)):
        lines += [f".SH {title}", *(line for row in rows for line in _item(*row))]
    return "\n".join(lines) + "\n"


def _command(name: str, command: Any) -> Iterator[str]:  # noqa: ANN401 - a command of click
    context = typer.Context(command, info_name=name)
    usage = " ".join(re.sub(r"^\{(.*)\}$", r"\1", piece) for piece in command.collect_usage_pieces(context))
    yield f".SS imuwb {_escaped(name)}"
    yield f".B imuwb {_escaped(name)}"
    yield _escaped(usage) or "\\&"
    text, example = parted(command.help or "")
    for paragraph in filter(None, text.split("\n\n")):
        yield ".PP"
        yield _text(paragraph)
    for param in command.params:
        record = param.get_help_record(context)
        if record is not None and param.name not in ALWAYS:
            yield from _item(*record)
    if example:
        yield from (".PP", "Example:", ".PP", ".RS", f".B {_escaped(example)}", ".RE")


def _item(name: str, text: str) -> list[str]:
    """Return a paragraph with a tag."""
    return [".TP", f".B {_escaped(name)}", _text(text) or "\\&"]


def _text(text: str) -> str:
    """Return running text on one line."""
    return _escaped(" ".join(text.split()))


def _escaped(text: str) -> str:
    """Return a text in which no letter is a command of roff; a hyphen is one that can be copied."""
    escaped = text.replace("\\", "\\e").replace("-", "\\-").replace('"', "\\(dq")
    return f"\\&{escaped}" if escaped.startswith((".", "'")) else escaped


if __name__ == "__main__":
    sys.stdout.reconfigure(encoding="utf-8")  # pyright: ignore[reportAttributeAccessIssue] - a file has it
    sys.stdout.write(manual())

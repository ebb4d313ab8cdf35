"""The command line: a command per analysis, an option per parameter."""

from __future__ import annotations

import io
import os
import sys
import warnings
from pathlib import Path

from imuwb.errors import ImuwbError

INTERRUPTED = 130  #: what shells expect of a program that Ctrl-C ended


def main() -> None:
    """Run the command line; every error is a message on stderr and an exit code, never a traceback."""
    warnings.showwarning = _warn
    _prepare_streams()
    try:
        from imuwb.cli.app import build  # noqa: PLC0415 - what fails on import is reported like the rest

        build(sys.argv[1:])(prog_name="imuwb")
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # the reader of our output has left
        sys.exit(1)
    except (KeyboardInterrupt, SystemExit) as leaving:
        if isinstance(leaving, SystemExit) and leaving.code != INTERRUPTED:
            raise
        _say("imuwb: interrupted; what was not finished is not written")
        sys.exit(INTERRUPTED)
    except Exception as error:
        if os.environ.get("IMUWB_TRACEBACK") and not isinstance(error, ImuwbError):
            raise
        _say(f"imuwb: {_explained(error)}")
        sys.exit(error.exit_code if isinstance(error, ImuwbError) else 1)


def _explained(error: Exception) -> str:
    if isinstance(error, ImuwbError):
        return str(error)
    if isinstance(error, OSError):
        return f"{error.filename or 'output'}: {error.strerror or error}"
    if isinstance(error, MemoryError):
        return "the log does not fit in memory; analyse a part of it with --start and --end"
    return (
        f"internal error: {type(error).__name__}: {error}\n"
        "This is a fault of imuwb; run again with IMUWB_TRACEBACK=1 and report what it prints."
    )


def _prepare_streams() -> None:
    sys.stdout = sys.stdout or Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115 - whoever started us closed it
    sys.stderr = sys.stderr or sys.stdout
    for stream in (sys.stdout, sys.stderr):
        # Units have letters that a pipe's or an old console's encoding may lack.
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(encoding=stream.encoding if stream.isatty() else "utf-8", errors="replace")


def _say(text: str) -> None:
    print(text, file=sys.stderr)  # noqa: T201 - this is the command line


def _warn(message: Warning | str, category: type[Warning], *_: object, **__: object) -> None:
    del category
    _say(f"imuwb: warning: {message}")

"""The command line: a command per analysis, an option per parameter."""

from __future__ import annotations

import io
import os
import sys
import warnings

from imuwb.errors import ImuwbError


def main() -> None:
    """Run the command line; every error is a message on stderr and an exit code, never a traceback."""
    warnings.showwarning = _warn
    for stream in (sys.stdout, sys.stderr):
        # Units have letters that a pipe's or an old console's encoding may lack.
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(encoding=stream.encoding if stream.isatty() else "utf-8", errors="replace")
    try:
        from imuwb.cli.app import build  # noqa: PLC0415 - what fails on import is reported like the rest

        build(sys.argv[1:])(prog_name="imuwb")
    except ImuwbError as error:
        _say(f"imuwb: {error}")
        sys.exit(error.exit_code)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # the reader of our output has left
        sys.exit(1)
    except MemoryError:
        _say("imuwb: the log does not fit in memory; analyse a part of it with --start and --end")
        sys.exit(1)
    except Exception as error:
        if os.environ.get("IMUWB_TRACEBACK"):
            raise
        _say(
            f"imuwb: internal error: {type(error).__name__}: {error}\n"
            "This is a fault of imuwb; run again with IMUWB_TRACEBACK=1 and report what it prints."
        )
        sys.exit(1)


def _say(text: str) -> None:
    print(text, file=sys.stderr)  # noqa: T201 - this is the command line


def _warn(message: Warning | str, category: type[Warning], *_: object, **__: object) -> None:
    del category
    _say(f"imuwb: warning: {message}")

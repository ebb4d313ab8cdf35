"""The command line: a command for each analysis, an option for each parameter."""

import errno
import os
import sys
import warnings

from imuwb import own_process
from imuwb.cli.ending import INTERRUPTED, Signals, prepare_streams
from imuwb.errors import ImuwbError

_warned: list[str] = []  #: warnings that were printed

#: what an import and a thread that get no memory say
NO_MEMORY = ("failed to map segment from shared object", "cannot allocate memory", "can't start new thread")


def program() -> None:
    """Run the command line as the program of this process."""
    own_process.run_program(main)


def main() -> None:
    """Run the command line. Every error is a message on stderr and an exit code, never a traceback."""
    own_process.command_line()
    warnings.showwarning = _print_warning
    prepare_streams()
    with Signals() as signals:
        try:
            _run(signals)
        finally:
            _tell_cost()


def _run(signals: Signals) -> None:
    try:
        # Imported here, so that an error on import is reported like the others.
        from imuwb.cli.app import build  # noqa: PLC0415
        from imuwb.cli.completion import ASKED, words_before  # noqa: PLC0415

        arguments = words_before(os.environ) if ASKED in os.environ else sys.argv[1:]
        build(arguments)(prog_name="imuwb")
    except (KeyboardInterrupt, SystemExit) as leaving:
        if isinstance(leaving, SystemExit) and leaving.code != INTERRUPTED:
            raise
        _print("imuwb: interrupted; unfinished files are not written")
        sys.exit(signals.exit_code)
    except Exception as error:
        if os.environ.get("IMUWB_TRACEBACK") and not isinstance(error, ImuwbError):
            raise
        if _is_fault(error):
            from imuwb.cli.last_fault import remember  # noqa: PLC0415 - only for a fault

            remember(error, sys.argv[1:])
        _print(f"imuwb: {_message_of(error)}")
        sys.exit(error.exit_code if isinstance(error, ImuwbError) else 1)


def _is_fault(error: Exception) -> bool:
    """Return whether an error is a fault of imuwb, and not one of what it was given."""
    return not isinstance(error, ImuwbError | OSError | MemoryError) and not _lacks_memory(error)


def _lacks_memory(error: Exception) -> bool:
    """Return whether there was too little memory; imports and threads say so in words of the system."""
    return isinstance(error, MemoryError) or any(words in str(error) for words in NO_MEMORY)


def _message_of(error: Exception) -> str:
    from imuwb.readers.bytes.address import without_secrets  # noqa: PLC0415 - only for messages
    from imuwb.texts import printable_lines  # noqa: PLC0415

    return printable_lines(without_secrets(_text_of(error)))


def _text_of(error: Exception) -> str:
    if isinstance(error, ImuwbError):
        return str(error)
    if isinstance(error, OSError) and error.errno in (errno.EMFILE, errno.ENFILE):
        return "too many files are open at once; allow more (ulimit -n 256)"
    if isinstance(error, OSError):
        return f"{error.filename or 'output'}: {error.strerror or error}"
    if _lacks_memory(error):
        return "this does not fit in memory; analyse a part of the log with --start and --end, or allow more memory (ulimit -v)"
    return (
        f"internal error: {type(error).__name__}: {error}\n"
        "This is a fault of imuwb. imuwb bug-report collects what a report needs; IMUWB_TRACEBACK=1 shows where it happens."
    )


def _tell_cost() -> None:
    """State once that compiled code could not be kept; libraries that are at work then may have hidden the warning."""
    kept_code = sys.modules.get("imuwb.kept_code")  # not imported for this
    if kept_code is not None and kept_code.lost and kept_code.cost() not in _warned:
        _print(f"imuwb: warning: {kept_code.cost()}")


def _print(text: str) -> None:
    print(text, file=sys.stderr)  # noqa: T201 - this is the command line


def _print_warning(message: Warning | str, *_: object, **__: object) -> None:
    from imuwb.texts import printable_lines  # noqa: PLC0415 - only for messages

    _warned.append(str(message))
    _print(f"imuwb: warning: {printable_lines(str(message))}")

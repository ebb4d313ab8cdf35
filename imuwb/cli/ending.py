"""How a command ends before its time: by a signal; and how it goes on when nobody reads its output any more."""

import errno
import io
import os
import signal
import sys
import threading
import time
from pathlib import Path
from typing import Any, Self, TextIO

LEFT = (errno.EPIPE, errno.ESHUTDOWN, *((errno.EINVAL,) if os.name == "nt" else ()))
PATIENCE = 2.0  #: s; a signal that comes later after the first one ends the program at once
ENDING = ("SIGTERM", "SIGHUP")  #: besides SIGINT
INTERRUPTED = 130  #: exit code that shells expect from a program that Ctrl-C ended


class Output(io.FileIO):
    """A stream to a program that may end: what it does not read any more is dropped, and the work goes on."""

    def write(self, data: Any, /) -> int:  # noqa: ANN401 - any buffer
        """Write bytes, or drop them if the program that reads them has ended."""
        try:
            return super().write(data) or 0
        except OSError as error:
            if error.errno not in LEFT:
                raise
            return len(data)


def prepare_streams() -> None:
    """Make stdout and stderr safe: against letters that they cannot show, programs that do not read on, and closed streams."""
    _take_numbers()
    sys.stdout, sys.stderr = _safe(sys.stdout), _safe(sys.stderr)


def _take_numbers() -> None:
    """Open the null device in place of streams that the parent closed: else the first file that is opened takes their number."""
    while (number := os.open(os.devnull, os.O_RDWR)) <= 2:  # noqa: PLR2004 - stderr
        pass
    os.close(number)


def _safe(stream: TextIO | None) -> TextIO:
    if stream is None:  # the parent closed it
        return Path(os.devnull).open("w", encoding="utf-8")
    if not isinstance(stream, io.TextIOWrapper):
        return stream
    # Units have letters that the encoding of a pipe or of an old console may lack.
    encoding = stream.encoding if stream.isatty() else "utf-8"
    raw = getattr(stream.buffer, "raw", stream.buffer)  # with PYTHONUNBUFFERED there is no buffer
    if type(raw) is not io.FileIO:
        stream.reconfigure(encoding=encoding, errors="replace")
        return stream
    stream.flush()
    output = Output(raw.fileno(), "wb", closefd=False)
    if raw is stream.buffer:
        return io.TextIOWrapper(output, encoding, "replace", write_through=True)
    return io.TextIOWrapper(io.BufferedWriter(output), encoding, "replace", line_buffering=stream.line_buffering)


class Signals:
    """The signals that ask a program to end: inside the block they do what Ctrl-C does, so that no unfinished file is left."""

    def __init__(self) -> None:
        """Handle nothing yet."""
        self._number = int(signal.SIGINT)  #: of the signal that came
        self._first: float | None = None
        self._before: dict[int, Any] = {}

    def __enter__(self) -> Self:
        """Handle the signals from now on."""
        if threading.current_thread() is threading.main_thread():
            there = [getattr(signal, name) for name in ("SIGINT", *ENDING) if hasattr(signal, name)]
            wanted = [n for n in there if signal.getsignal(n) not in (signal.SIG_IGN, None)]  # nohup ignores SIGHUP
            self._before = {number: signal.signal(number, self._end) for number in wanted}
        return self

    def __exit__(self, *_: object) -> None:
        """Handle them as before."""
        for number, handler in self._before.items():
            signal.signal(number, handler)

    @property
    def exit_code(self) -> int:
        """The exit code that shells expect of a program that the signal ended."""
        return INTERRUPTED - signal.SIGINT + self._number

    def _end(self, number: int, frame: object) -> None:
        del frame
        now = time.monotonic()
        if self._first is None:
            self._first, self._number = now, number
            raise KeyboardInterrupt
        if now - self._first > PATIENCE:
            os._exit(self.exit_code)

"""Runs another engine with the fixes of an outage removed: a command with places for its inputs and its output."""

import os
import shlex
import shutil
import signal
import string
import subprocess
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from imuwb.errors import ImuwbError, UsageError
from imuwb.geodesy.local_track import LocalTrack
from imuwb.log import SECOND, GnssStream, ImuStream, Log, Reference, Triad
from imuwb.own_process import environment
from imuwb.readers import read_trajectory
from imuwb.replay import Outage, fixes_outside
from imuwb.writers import write

INTERPRETERS = ("python", "python3", "bash", "sh", "nice", "env", "octave")
AFTER = 1.0  #: s of samples after the end of an outage, so that a solution reaches it
PLACES = ("imu", "gnss", "output")
LONGEST = 200  #: letters of the engine's last line that are shown
TAIL = 4096  #: bytes at the end of stderr in which the last line is looked for
LARGEST = 2_000_000_000  #: bytes of a solution


@dataclass(frozen=True, slots=True)
class Command:
    """A command of words in which {imu}, {gnss} and {output} are places for files; no shell is involved."""

    words: tuple[str, ...]
    timeout: float  #: s

    @staticmethod
    def of(text: str, timeout: float) -> "Command":
        """Return the command of a text.

        Raises:
            UsageError: the text is no such command, or its program does not exist.
        """
        try:
            words = tuple(shlex.split(text))
            places = [name for word in words for _, name, _, _ in string.Formatter().parse(word) if name is not None]
        except ValueError as error:
            raise UsageError(
                f"--filter-command {text!r}: {error}; write for example './mine {{imu}} {{gnss}} {{output}}'"
            ) from error
        if sorted(places) != sorted(PLACES):
            raise UsageError(
                f"--filter-command {text!r}: it must have each of {{imu}}, {{gnss}} and {{output}} once; it has {', '.join(places) or 'none'}"
            )
        if shutil.which(words[0]) is None:
            raise UsageError(f"--filter-command {text!r}: there is no program {words[0]!r} that can be run")
        return Command(words, timeout)

    @property
    def name(self) -> str:
        """Return the program's name without folders and suffix; that of the script for an interpreter."""
        first = next((word for word in self.words if Path(word).stem not in INTERPRETERS), self.words[0])
        return Path(first).stem


@dataclass(frozen=True, eq=False, slots=True)
class EngineRun:
    """The solution of one run, or why there is none."""

    solution: Log | LocalTrack | Reference | None
    failure: str = ""


def run_engine(command: Command, log: Log, gnss: GnssStream, outage: Outage, delay: float = 0.0) -> EngineRun:
    """Return the solution of an engine that gets the samples up to a second after an outage, and the fixes up to its start.

    ``delay`` (s) is the time by which the stamps of the fixes are late; the engine gets the stamps as they are.
    The engine reads two CSV tables with headers, and writes a trajectory of any format that ``read_trajectory`` knows.
    """
    zero = log.zero or 0
    end = zero + round((outage.start + outage.duration + AFTER) * SECOND)
    before = fixes_outside(gnss, zero, [outage, Outage(outage.start, 1e9)], delay)
    with TemporaryDirectory(prefix="imuwb-") as folder:
        files = {place: str(Path(folder) / f"{place}.csv") for place in PLACES}
        write(Log(log.provenance, imus=(_until(log.imu(), end),), zero=zero), files["imu"])
        write(Log(log.provenance, gnss=(before,), zero=zero), files["gnss"])
        failure = _run([word.format(**files) for word in command.words], Path(folder), command.timeout)
        output = Path(files["output"])
        if not failure and not output.is_file():
            failure = "it ended without an error, but wrote no output"
        elif not failure and output.stat().st_size > LARGEST:
            failure = f"its output has more than {LARGEST // 10**9} GB"
        if failure:
            return EngineRun(None, failure)
        try:
            return EngineRun(read_trajectory(output, near=log.zero))
        except ImuwbError as error:
            return EngineRun(None, f"its output cannot be read: {str(error).replace(folder, '')}")


def _until(imu: ImuStream, end: int) -> ImuStream:
    """Return an IMU's samples up to a time, ns."""

    def cut(triad: Triad | None) -> Triad | None:
        if triad is None:
            return None
        last = int(np.searchsorted(triad.time, end, side="right"))
        return Triad(triad.time[:last], triad.value[:last])

    return replace(imu, angular_rate=cut(imu.angular_rate), specific_force=cut(imu.specific_force), temperature=None)


def _run(words: list[str], folder: Path, timeout: float) -> str:
    """Run a program to its end; return why it failed, or nothing."""
    said = folder / "stderr"
    with said.open("wb") as stderr:
        try:
            # No shell: the words are the user's own command, and each is one argument.
            process = subprocess.Popen(  # noqa: S603
                words,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=stderr,
                start_new_session=True,
                env=environment(),
            )
        except OSError as error:
            return f"it cannot be started: {error.strerror}"
        try:
            code = process.wait(timeout)
        except subprocess.TimeoutExpired:
            return f"it was stopped after {timeout:g} s (--filter-timeout)"
        finally:
            _end(process)
    if code == 0:
        return ""
    last = _last_line(said)
    how = f"exit code {code}" if code > 0 else f"ended by signal {-code}"
    return f"{how}: {last}" if last else how


def _end(process: "subprocess.Popen[bytes]") -> None:
    """End a program and what it has started, if it still runs."""
    if process.poll() is not None:
        return
    if hasattr(os, "killpg"):
        os.killpg(process.pid, signal.SIGKILL)  # its own session, so that its children end too
    else:
        process.kill()
    process.wait()


def _last_line(file: Path) -> str:
    """Return the last line that a program wrote, without control characters."""
    with file.open("rb") as stream:
        stream.seek(max(0, file.stat().st_size - TAIL))
        text = stream.read().decode("utf-8", "replace")
    lines = ["".join(c for c in line if c.isprintable()).strip() for line in text.splitlines()]
    return next((line for line in reversed(lines) if line), "")[:LONGEST]

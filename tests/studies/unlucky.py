"""What every command says on a poor machine: a full disk, a folder that cannot be written, few files, little memory, no output.

A row is what commands say alike under one condition. The goals: every failure is a plain sentence with an exit code of README; no
signal ends a command; no unfinished file is left; what could be written is whole.

* full disk: the folder is a file system of 64 kB (needs root; else a limit of 2 kB for each file).
* read-only folder: another user without rights in the folder runs the command (needs root).
* no cache: the package has no compiled code and is on a file system that cannot be written, and there is no home (needs root); a
  process of its own.
* closed output: stdout and stderr are closed. closed pipe: the programs that read both have ended.
* LANG=C: with PYTHONUTF8=0 and a log whose name has letters that ASCII lacks; a process of its own.
* decimal comma: the process has the numbers of a locale with a decimal comma.
* 40 columns: stdout and stderr are a terminal of 40 columns; the row states the widest line.
* 16 files: ulimit -n 16. memory: ulimit -v, this much above what the process has.

Command: ``python tests/studies/unlucky.py`` (10 minutes; Linux).
"""

from __future__ import annotations

import contextlib
import fcntl
import locale
import os
import re
import resource
import shutil
import struct
import subprocess
import sys
import tempfile
import termios
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from every_command import COMMANDS, Command, Run, chosen, drafts_in, files_of, inputs, ready
from study_report import Table, main

import imuwb

if TYPE_CHECKING:
    from collections.abc import Callable, Generator

QUESTION = "What commands say on poor machines"
NOBODY = 65534
MB = 1 << 20
LONGEST = 200  #: letters of a message in the table


@dataclass(frozen=True)
class Outcome:
    """How a command ended."""

    code: int
    said: str
    left: tuple[str, ...]  #: unfinished files
    wrote: int


def outcome(command: Command, run: Run, folder: Path) -> Outcome:
    """Return how a command in a child ended."""
    code = run.wait()
    return Outcome(code, run.said, tuple(drafts_in(folder)), len(files_of(command, folder)))


def nobody() -> None:
    """Become a user without rights."""
    os.setgroups([])
    os.setgid(NOBODY)
    os.setuid(NOBODY)


def closed() -> None:
    """Close the output; Python has no streams then."""
    for number in (1, 2):
        os.close(number)
    sys.stdout = sys.stderr = None


def closed_pipe() -> None:
    """Make the output a pipe that nobody reads."""
    read, write = os.pipe()
    os.close(read)
    os.dup2(write, 1)
    os.dup2(write, 2)


def few_files() -> None:
    """Allow 16 open files."""
    resource.setrlimit(resource.RLIMIT_NOFILE, (16, 16))


def small_files() -> None:
    """Allow files of 2 kB."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))


def memory(room: int) -> Callable[[], None]:
    """Return what allows so many MB above what the process has."""

    def limit() -> None:
        pages = int(Path("/proc/self/statm").read_text().split()[0])
        most = pages * resource.getpagesize() + room * MB
        resource.setrlimit(resource.RLIMIT_AS, (most, most))

    return limit


def comma() -> None:
    """Use a locale with a decimal comma."""
    locale.setlocale(locale.LC_ALL, "de_DE.UTF-8")
    assert locale.localeconv()["decimal_point"] == ","


CONDITIONS: dict[str, Callable[[], None]] = {
    "as it is": lambda: None, "read-only folder": nobody, "closed output": closed, "closed pipe": closed_pipe, "decimal comma": comma,
    "16 files": few_files, "memory + 16 MB": memory(16), "memory + 128 MB": memory(128), "memory + 512 MB": memory(512),
}  # fmt: skip


@contextlib.contextmanager
def full_disk(root: Path) -> Generator[tuple[Path, Callable[[], None]]]:
    """Yield a folder of a small file system, or any folder and what limits the size of files."""
    folder = root / "full"
    folder.mkdir()
    mounted = subprocess.run(
        ["/bin/mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", folder], check=False, stderr=subprocess.DEVNULL
    )
    try:
        yield folder, small_files if mounted.returncode else lambda: None
    finally:
        if not mounted.returncode:
            subprocess.run(["/bin/umount", folder], check=True)


def in_terminal(command: Command, made: Path, folder: Path) -> tuple[Outcome, int]:
    """Run a command in a terminal of 40 columns; return how it ended, and the width of its widest line."""
    ours, theirs = os.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 40, 0, 0))
    os.environ.pop("COLUMNS", None)

    def attach() -> None:
        os.environ["TERM"] = "xterm"
        for number in (1, 2):
            os.dup2(theirs, number)

    run, said = Run(command.arguments(made), folder, before=attach), b""
    os.close(theirs)
    with contextlib.suppress(OSError):  # the terminal ends with the child
        while piece := os.read(ours, 4096):
            said += piece
    os.close(ours)
    code = run.wait()
    shown = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", said.decode("utf-8", "replace"))
    widest = max((len(line.rpartition("\r")[2]) for line in shown.replace("\r\n", "\n").split("\n")), default=0)
    return Outcome(code, run.said, tuple(drafts_in(folder)), len(files_of(command, folder))), widest


def of_process(command: Command, made: Path, folder: Path, environment: dict[str, str]) -> Outcome:
    """Run a command in a process of its own."""
    words = [Path(word).read_text() if word.endswith("/seed") else word for word in command.arguments(made)]
    done = subprocess.run(
        [sys.executable, "-m", "imuwb", *words], cwd=folder, env=environment, stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE, check=False,
    )  # fmt: skip
    said = done.stderr.decode("utf-8", "replace")
    return Outcome(done.returncode, said, tuple(drafts_in(folder)), len(files_of(command, folder)))


def plain(text: str, folders: list[Path]) -> str:
    """Return what a command said last, without the names of folders."""
    lines = [line.strip() for line in text.splitlines() if line.strip() and not line.startswith(("note ", "wrote "))]
    said = lines[-1] if lines else ""
    for folder in sorted(folders, key=lambda f: -len(str(f))):
        said = said.replace(f"{folder}/", "").replace(str(folder), "FOLDER")
    said = re.sub(
        r"\bo/[\w.-]+|\b[ofns]\.(gnss\.|reference\.)?(rrd|json|html|toml|csv|mcap|yaml)(\.toml)?\b", "FILE", said
    )
    said = re.sub(r"imuwb-\w+|\d+(\.\d+)? (MiB|GiB|KiB)", "N", said)
    return said if len(said) <= LONGEST else f"{said[:LONGEST]}…"


def is_plain(found: Outcome) -> bool:
    """Return whether a command ended well: done, or failed with a sentence."""
    lost = found.left or found.code < 0 or found.code > 4
    return not lost and "Traceback" not in found.said and "internal error" not in found.said


def rows_of(condition: str, found: dict[str, Outcome], folders: list[Path]) -> list[tuple[object, ...]]:
    """Return a row for the commands that say the same."""
    alike = defaultdict[tuple[object, ...], list[str]](list)
    for name, one in found.items():
        said = plain(one.said, folders) if one.code else ""
        alike[one.code, said, is_plain(one)].append(name)
    return [(condition, len(names), ", ".join(names), code, said or "(done)", "yes" if good else "NO")
            for (code, said, good), names in alike.items()]  # fmt: skip


@contextlib.contextmanager
def without_code(root: Path) -> Generator[Path]:
    """Copy the package without compiled code to a file system that cannot be written, and yield the folder for PYTHONPATH."""
    place = root / "package"
    place.mkdir()
    subprocess.run(["/bin/mount", "-t", "tmpfs", "-o", "size=64m", "tmpfs", place], check=True)
    try:
        skip = shutil.ignore_patterns("__pycache__", "tests", "*.pyc")
        source = Path(imuwb.__file__).parent
        shutil.copytree(source, place / "imuwb", ignore=skip)
        shutil.copytree(source.parent / "plugins" / "imuwb_plugins", place / "imuwb_plugins", ignore=skip)
        subprocess.run(["/bin/mount", "-o", "remount,ro", place], check=True)
        yield place
    finally:
        subprocess.run(["/bin/umount", place], check=True)


def compile_a_locale(folder: Path) -> None:
    """Compile a locale whose decimal sign is a comma, and let the next processes find it."""
    folder.mkdir()
    words = ["/usr/bin/localedef", "-i", "de_DE", "-f", "UTF-8", folder / "de_DE.UTF-8"]
    subprocess.run(words, check=False, stderr=subprocess.DEVNULL)
    os.environ["LOCPATH"] = str(folder)


def study(records: int) -> tuple[Table, ...]:
    """Run all commands under all conditions."""
    commands = chosen(records)
    rows = list[tuple[object, ...]]()
    with tempfile.TemporaryDirectory() as name:
        root = Path(name).resolve()
        root.chmod(0o755)
        compile_a_locale(root / "locales")
        ready()
        made, here = inputs(root / "in", 1), root / "here"
        folders = [made, here, root / "full", root]

        def fresh() -> Path:
            shutil.rmtree(here, ignore_errors=True)
            here.mkdir()
            return here

        def add(condition: str, found: dict[str, Outcome]) -> None:
            rows.extend(rows_of(condition, found, folders))
            print(*rows_of(condition, found, folders), sep="\n", flush=True)

        for condition, before in CONDITIONS.items():
            add(condition, {c.name: outcome(c, Run(c.arguments(made), fresh(), before=before), here) for c in commands})
        with full_disk(root) as (folder, before):
            found = dict[str, Outcome]()
            for command in commands:
                found[command.name] = outcome(command, Run(command.arguments(made), folder, before=before), folder)
                for path in folder.iterdir():
                    shutil.rmtree(path) if path.is_dir() else path.unlink()
            add("full disk", found)
        narrow = {c.name: in_terminal(c, made, fresh()) for c in commands}
        add("40 columns", {name: one for name, (one, _) in narrow.items()})
        wide = max(narrow, key=lambda name: narrow[name][1])
        rows.append(("40 columns", 1, wide, "", f"the widest line has {narrow[wide][1]} columns", ""))
        shutil.copy(made / "static.mcap", made / "stätic°.mcap")
        odd = [Command(c.name, c.words.replace("static.mcap", "stätic°.mcap"), c.outputs) for c in commands]
        plain_ascii = {**os.environ, "LC_ALL": "C", "LANG": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
        add("LANG=C", {c.name: of_process(c, made, fresh(), plain_ascii) for c in odd})
        some = [c for c in commands if c.name in ("info", "convert .csv", "noise", "psd")]
        with without_code(root) as package:
            poor = {
                **os.environ,
                "PYTHONPATH": f"{package}{os.pathsep}{os.environ.get('PYTHONPATH', '')}",
                "HOME": "/proc/none",
            }
            poor.pop("NUMBA_CACHE_DIR", None)
            found = {command.name: of_process(command, made, fresh(), poor) for command in some}
        add("no cache", found)
        warned = next((one.said for one in found.values() if "cannot be kept" in one.said), "no warning")
        rows.append(("no cache", len(found), "the warning", "", plain(warned, folders), ""))
    bad = sum(int(row[1]) for row in rows if row[-1] == "NO")
    head = f"{bad} of {sum(int(row[1]) for row in rows if row[-1])} runs do not end in a result or in a plain sentence, or leave an unfinished file."
    return (
        Table(
            "All conditions", ("condition", "commands", "which", "exit code", "last line", "plain"), tuple(rows), head
        ),
    )


if __name__ == "__main__":
    main(__file__, QUESTION, study, len(COMMANDS), lambda records: f"{records} commands")

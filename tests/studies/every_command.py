"""Every command of imuwb on small inputs, for the studies of what befalls a command: kills, poor machines, system calls.

A command is run in a child that is forked from a process with all imports done, so that a run costs its own work only.
"""

from __future__ import annotations

import contextlib
import os
import sys
import time
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from imuwb import renames

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping


@dataclass(frozen=True)
class Command:
    """A command; ``{in}`` stands for the folder of its inputs."""

    name: str
    words: str
    outputs: tuple[str, ...] = ()  #: files that it writes; ``FOLDER/*``: all in a folder

    def arguments(self, inputs: Path) -> list[str]:
        return [word.replace("{in}", str(inputs)) for word in self.words.split()]


_BOTH, _ALL = (f" -o o.rrd --json o.json{page} --force" for page in ("", " --html o.html"))
_TWO, _FILES = ("o.rrd", "o.json"), ("o.rrd", "o.json", "o.html")
_MODEL = " --save-model o.toml"
_POINTS = ("1_0C.mcap", "2_plus-10C.mcap", "3_plus-20C.mcap")
COMMANDS = (
    Command("info", "info {in}/static.mcap"),
    Command("info --json", "info {in}/drive.mcap --json"),
    Command("plugins", "plugins"),
    Command("convert .csv", "convert {in}/drive.mcap -o o.csv --force",
            ("o.csv", "o.csv.toml", "o.gnss.csv", "o.gnss.csv.toml", "o.reference.csv", "o.reference.csv.toml")),
    Command("convert .mcap", "convert {in}/static.csv -o o.mcap --force", ("o.mcap",)),
    Command("simulate static", "simulate static --preset mpu-6050 --hours 0.01 --rate 50 --seed {in}/seed -o o.csv --force",
            ("o.csv", "o.csv.toml")),
    Command("simulate drive", "simulate drive --sensor mpu-6050 --duration 90 --rate 50 --seed {in}/seed -o o.mcap --force", ("o.mcap",)),
    Command("simulate chamber",
            "simulate chamber --preset motionpakii --hours 0.01 --from 0 --to 20 --step 10 --rate 20 --seed {in}/seed -o o --force", ("o/*",)),
    Command("simulate six-position",
            "simulate six-position --preset mpu-6050 --minutes 0.1 --rate 50 --format csv --seed {in}/seed -o o --force", ("o/*",)),
    Command("simulate hand-held",
            "simulate hand-held --preset mpu-6050 --positions 9 --rate 50 --seed {in}/seed -o o --force", ("o/*",)),
    Command("simulate rate-table",
            "simulate rate-table --preset mpu-6050 --rates 50 --seconds 5 --rate 50 --seed {in}/seed -o o --force", ("o/*",)),
    Command("noise", "noise {in}/static.mcap" + _ALL + _MODEL, (*_FILES, "o.toml")),
    Command("allan", "allan {in}/static.mcap" + _BOTH + _MODEL, (*_TWO, "o.toml")),
    Command("psd", "psd {in}/static.mcap" + _ALL, _FILES),
    Command("autocorrelation", "autocorrelation {in}/static.mcap" + _BOTH, _TWO),
    Command("autoregressive", "autoregressive {in}/static.mcap" + _BOTH + _MODEL, (*_TWO, "o.toml")),
    Command("lssa", "lssa {in}/static.mcap" + _BOTH, _TWO),
    Command("health", "health {in}/static.mcap" + _BOTH, _TWO),
    Command("temperature", "temperature" + "".join(f" {{in}}/chamber/{name}" for name in _POINTS) + _BOTH + _MODEL, (*_TWO, "o.toml")),
    Command("calibration six-position", "calibration six-position" + "".join(f" {{in}}/cube/{way}_{axis}.mcap" for axis in "xyz" for way in ("up", "down"))
            + _BOTH + _MODEL, (*_TWO, "o.toml")),
    Command("outage", "outage {in}/drive.mcap --error-model {in}/m.toml --at 75:10 --models none,15AV --save-filter f.toml --navigation n.csv "
            "--smoothed s.csv" + _BOTH, (*_TWO, "f.toml", "n.csv", "n.csv.toml", "s.csv", "s.csv.toml")),
    Command("model show", "model show {in}/m.toml -o o.rrd --force", ("o.rrd",)),
    Command("model compare", "model compare {in}/m.toml {in}/m2.toml -o o.rrd --force", ("o.rrd",)),
    Command("model export", "model export {in}/m.toml --to kalibr -o o.yaml --force", ("o.yaml",)),
    Command("model check", "model check {in}/m.toml --against {in}/m.toml --factor 10"),
)  # fmt: skip


#: with ``--records N`` the first commands; each is the one of its kind
FIRST = ("info", "convert .csv", "psd", "model show", "simulate six-position", "model export", "outage")


def chosen(count: int) -> list[Command]:
    """Return so many commands, first one of each kind."""
    return sorted(COMMANDS, key=lambda c: FIRST.index(c.name) if c.name in FIRST else len(FIRST))[:count]


def ready() -> None:
    """Import what the commands use, once for all children."""
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    from imuwb import registry
    from imuwb.cli import perform
    from imuwb.review.page import html
    from imuwb.signatures import compile_all
    from imuwb.writers import csv_text

    for name in (
        "matplotlib.backends.backend_svg",
        "pandas",
        "scipy.optimize",
        "scipy.signal",
        "scipy.stats",
    ):
        import_module(name)
    del perform, html, csv_text
    for point in registry.installed(registry.ANALYSES).values():
        registry.load(point)
    compile_all()


def inputs(folder: Path, seed: int) -> Path:
    """Make the inputs of all commands in a new folder, each of its own seed, and return it."""
    folder.mkdir()
    (folder / "seed").write_text(str(seed))
    common = f"--seed {seed}"
    lines = (
        f"simulate static --preset 3dm-gx3-25 --hours 0.005 --rate 50 {common} -o static.mcap", "convert static.mcap -o static.csv",
        f"simulate drive --sensor mpu-6050 --duration 120 --rate 50 {common} -o drive.mcap",
        f"simulate chamber --preset motionpakii --hours 0.02 --from 0 --to 20 --step 10 --rate 20 {common} -o chamber",
        f"simulate six-position --preset mpu-6050 --minutes 0.2 --rate 50 {common} -o cube",
        "noise static.mcap --save-model m.toml --force-model -o m.rrd", "allan static.mcap --save-model m2.toml --force-model -o m2.rrd",
    )  # fmt: skip
    for line in lines:
        run = Run(line.split(), folder)
        if run.wait():
            raise SystemExit(f"imuwb {line}: exit code {run.code}\n{run.said}")
    return folder


class Run:
    """A command in a child process."""

    def __init__(self, words: list[str], folder: Path, *, before: Callable[[], None] = lambda: None) -> None:
        """Start it in a folder; ``before`` is called in the child."""
        words = [Path(word).read_text() if word.endswith("/seed") else word for word in words]
        self._errors = folder.with_name(f".{folder.name}.stderr")  # not on the disk that may be full
        self.began = time.perf_counter()
        self.pid = os.fork()
        self.code: int | None = None
        if not self.pid:
            os._exit(_run(words, folder, self._errors, before))

    def wait(self) -> int:
        """Return the exit code; negative: the number of the signal that ended it."""
        if self.code is None:
            _, status = os.waitpid(self.pid, 0)
            self.code = os.waitstatus_to_exitcode(status)
            self.took = time.perf_counter() - self.began
            self.said = self._errors.read_text("utf-8", "replace") if self._errors.exists() else ""
            self._errors.unlink(missing_ok=True)
        return self.code


def _run(words: list[str], folder: Path, errors: Path, before: Callable[[], None]) -> int:
    """Run a command in this process, and return its exit code."""
    code = 70
    try:
        os.chdir(folder)
        null, said = os.open(os.devnull, os.O_RDWR), os.open(errors, os.O_RDWR | os.O_CREAT | os.O_TRUNC, 0o600)
        for number, target in ((0, null), (1, null), (2, said)):
            os.dup2(target, number)
        sys.argv = ["imuwb", *words]
        sys.stdout, sys.stderr = (open(number, "w", encoding="utf-8", closefd=False) for number in (1, 2))  # noqa: SIM115
        before()
        from imuwb.cli import main

        main()
        code = 0
    except SystemExit as leaving:
        code = leaving.code if isinstance(leaving.code, int) else 0
    except BaseException:  # noqa: BLE001 - the parent reads it
        import traceback

        traceback.print_exc()
    finally:
        with contextlib.suppress(Exception):
            sys.stdout.flush()
            sys.stderr.flush()
    return code


def files_of(command: Command, folder: Path) -> Mapping[str, bytes]:
    """Return the outputs that are there, {name: content}."""

    def found() -> Iterator[Path]:
        for name in command.outputs:
            yield from sorted(folder.glob(name)) if "*" in name else [folder / name]

    return {
        str(path.relative_to(folder)): path.read_bytes() for path in found() if path.is_file() and not _is_draft(path)
    }


def drafts_in(folder: Path) -> list[str]:
    """Return the names of unfinished files in a folder and below."""
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if _is_draft(path))


def _is_draft(path: Path) -> bool:
    return path.name.startswith(".") and path.name.endswith((".partial", renames.SUFFIX))


def in_child(work: Callable[[str], str], path: Path) -> str:
    """Return what a function says of a file; it runs in a child, so that its libraries start no threads in this process."""
    read, write = os.pipe()
    pid = os.fork()
    if not pid:
        with contextlib.suppress(BaseException):
            os.close(read)
            os.write(write, work(str(path)).encode())
        os._exit(0)
    os.close(write)
    with os.fdopen(read, "rb") as pipe:
        text = pipe.read().decode()
    os.waitpid(pid, 0)
    return text

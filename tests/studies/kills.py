"""Kill every command that writes, at random moments and at every rename, and look at what is left.

Each command runs over its own earlier outputs, which were made of other inputs. A child is ended by SIGKILL, SIGTERM or SIGINT
at a moment drawn evenly from the time that a whole run takes; or by SIGKILL just before its n-th rename or removal of a file, for every n.
Each file is then compared with the earlier one and with that of a whole run: first as other programs see the files, then after imuwb has
looked for one of them, each in turn, as all its commands do that read or write one. Where SIGKILL leaves unfinished files, the command runs
again; of the renames, after the first two.

* old, new: all files are the earlier ones, or all are new.
* between: some are old and some are new, each whole.
* between for others: as other programs see the files before imuwb has looked for one. No file system renames several files at once.
* damaged: a file is neither. The goal is 0.
* left by a signal: runs after SIGTERM or SIGINT with unfinished files; the goal is 0. left after the next run: likewise.
* wrong reading: a table with a sidecar reads neither as the old nor as the new one, nor is it refused; the goal is 0.

Command: ``python tests/studies/kills.py`` (500 kills: 10 minutes; Linux and macOS).
Seeds: 0, of the moments.
"""

from __future__ import annotations

import os
import shutil
import signal
import tempfile
import time
from collections import Counter
from pathlib import Path

import numpy as np
from every_command import COMMANDS, Command, Run, drafts_in, files_of, in_child, inputs, ready
from study_report import Table, main

from imuwb import renames

QUESTION = "Kills of every command that writes"
SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)
CHEAP = ("convert", "simulate", "model")  #: commands that get four times as many kills
RERUNS = 2  #: renames after which the command runs again
STATES = ("old", "new", "between", "damaged")


def run_named(path: str) -> str:
    """Return the run that a whole recording names; empty: it is not whole."""
    from imuwb.errors import UnreadableLogError
    from imuwb.review.recording import recorded

    try:
        found = recorded.read(path)
    except UnreadableLogError:
        return ""
    return str(found.properties.get("run", "whole"))


def reading(path: str) -> str:
    """Return what a table reads as: its epoch, frame and first values; or that it is refused."""
    from imuwb import readers
    from imuwb.errors import ImuwbError

    try:
        log = readers.read(path)
    except ImuwbError as error:
        return f"refused with exit code {error.exit_code}"
    streams = (*log.imus, *log.gnss, *log.references)
    values = [s.specific_force.value[0] if hasattr(s, "specific_force") else s.position[0] for s in streams]
    return repr([(s.origin.epoch, s.origin.frame, list(v)) for s, v in zip(streams, values, strict=True)])


def settled(path: str) -> str:
    """Do what imuwb does before it reads a file."""
    renames.settle(Path(path))
    return ""


class Trial:
    """One command, its earlier outputs, and those of a whole run."""

    def __init__(self, command: Command, old_inputs: Path, new_inputs: Path, root: Path) -> None:
        self.command, self.inputs = command, new_inputs
        self.folder = root / "here"
        self.old = self._whole(old_inputs)
        self._old_readings = self._readings()
        self.new = self._whole(new_inputs)
        self._new_readings = self._readings()
        self._runs = {name: in_child(run_named, self.folder / name) for name in self.new if name.endswith(".rrd")}

    def _whole(self, made_of: Path) -> dict[str, bytes]:
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir()
        run = Run(self.command.arguments(made_of), self.folder)
        if run.wait():
            raise SystemExit(f"{self.command.name}: exit code {run.code}\n{run.said}")
        self.took = run.took
        return dict(files_of(self.command, self.folder))

    def _readings(self) -> dict[str, str]:
        tables = [name for name in files_of(self.command, self.folder) if f"{name}.toml" in os.listdir(self.folder)]
        return {name: in_child(reading, self.folder / name) for name in tables}

    def restore(self) -> None:
        """Put the earlier outputs back."""
        shutil.rmtree(self.folder)
        for name, content in self.old.items():
            place = self.folder / name
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_bytes(content)

    def start(self, before=lambda: None) -> Run:
        return Run(self.command.arguments(self.inputs), self.folder, before=before)

    def state(self) -> str:
        """Return what the files are together."""
        found = files_of(self.command, self.folder)
        kinds = {self._kind(name, found.get(name)) for name in {*self.old, *self.new}}
        if "damaged" in kinds:
            return "damaged"
        kinds.discard("both")
        return "between" if len(kinds) > 1 else kinds.pop() if kinds else "old"

    def settled(self, turn: int) -> str:
        """Return what the files are together after imuwb has looked for one of them."""
        asked = sorted({*self.old, *self.new})
        in_child(settled, self.folder / asked[turn % len(asked)])
        return self.state()

    def _kind(self, name: str, content: bytes | None) -> str:
        old, new = self.old.get(name), self.new.get(name)
        if content in (old, new):
            return "both" if old == new else "old" if content == old else "new"
        if name in self._runs and in_child(run_named, self.folder / name) == self._runs[name]:
            return "new"  # a recording has times of its own
        return "damaged"

    def wrong_readings(self) -> int:
        known = (self._old_readings, self._new_readings)
        return sum(
            text not in (*(readings.get(name) for readings in known), "refused with exit code 4")
            for name, text in self._readings().items()
        )


def random_kills(trial: Trial, count: int, rng: np.random.Generator) -> Counter[str]:
    """Kill a command at random moments."""
    seen = Counter[str]()
    for number in range(count):
        trial.restore()
        how = SIGNALS[number % len(SIGNALS)]
        run = trial.start()
        time.sleep(rng.uniform(0, trial.took))
        os.kill(run.pid, how)  # it may have ended: it is a child whose exit code is not read yet
        run.wait()
        seen["between for others"] += trial.state() == "between"
        state = trial.settled(number)
        seen[state] += 1
        seen["wrong reading"] += trial.wrong_readings() if state == "between" else 0  # else the bytes are known
        if drafts_in(trial.folder):
            if how != signal.SIGKILL:
                seen["left by a signal"] += 1
                print(trial.command.name, how, drafts_in(trial.folder), run.said, flush=True)
            trial.start().wait()
            seen["left after the next run"] += bool(drafts_in(trial.folder)) or trial.state() not in ("new", "old")
            seen["runs again"] += 1
    return seen


def rename_kills(trial: Trial) -> Counter[str]:
    """Kill a command before each of its renames and removals of files."""
    seen = Counter[str]()
    for place in range(100):

        def before(left=place) -> None:
            done = [0]

            def killing(work):
                def killed(self, *arguments, **named):
                    if str(self).startswith(str(trial.folder)):
                        if done[0] == left:
                            os.kill(os.getpid(), signal.SIGKILL)
                        done[0] += 1
                    return work(self, *arguments, **named)

                return killed

            Path.replace, Path.unlink = killing(Path.replace), killing(Path.unlink)

        trial.restore()
        if trial.start(before).wait() != -signal.SIGKILL:
            return seen
        seen["kills"] += 1
        seen["between for others"] += trial.state() == "between"
        seen[trial.settled(place)] += 1
        seen["wrong reading"] += trial.wrong_readings()
        if place < RERUNS:
            trial.start().wait()
            seen["left after the next run"] += bool(drafts_in(trial.folder)) or trial.state() not in ("new", "old")
    raise SystemExit(f"{trial.command.name}: more than 100 renames and removals")


def study(records: int) -> tuple[Table, ...]:
    """Kill each command, at random and at its renames."""
    ready()
    rng = np.random.default_rng(0)
    writing = [command for command in COMMANDS if command.outputs]
    shares = [4 if command.name.startswith(CHEAP) else 1 for command in writing]
    counts = [max(3, round(records * share / sum(shares))) for share in shares]
    kills, renames = list[tuple[object, ...]](), list[tuple[object, ...]]()
    with tempfile.TemporaryDirectory() as name:
        root = Path(name).resolve()
        old, new = inputs(root / "old", 1), inputs(root / "new", 2)
        for command, count in zip(writing, counts, strict=True):
            trial = Trial(command, old, new, root)
            seen = random_kills(trial, count, rng)
            more = ("between for others", "left by a signal", "runs again", "left after the next run", "wrong reading")
            kills.append((command.name, count, *(seen[kind] for kind in (*STATES, *more))))
            seen = rename_kills(trial)
            renames.append(
                (
                    command.name,
                    seen["kills"],
                    *(
                        seen[kind]
                        for kind in (*STATES, "between for others", "left after the next run", "wrong reading")
                    ),
                )
            )
            print(kills[-1], renames[-1], flush=True)
    for rows in (kills, renames):
        rows.append(("all", *(sum(int(row[i]) for row in rows) for i in range(1, len(rows[0])))))
    others, after = "between for others", ("left after the next run", "wrong reading")
    random, every = (
        "SIGKILL, SIGTERM and SIGINT in turn.",
        "SIGKILL just before each rename and each removal of a file.",
    )
    return (
        Table(
            "Random moments",
            ("command", "kills", *STATES, others, "left by a signal", "runs again", *after),
            tuple(kills),
            random,
        ),
        Table("Every rename and removal", ("command", "kills", *STATES, others, *after), tuple(renames), every),
    )


if __name__ == "__main__":
    main(__file__, QUESTION, study, 500, lambda records: f"{records} kills at random moments")

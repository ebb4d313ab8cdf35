"""Trace the system calls of every command: no socket but what the user asks for, no program but the viewer.

A row states the sockets of a command by their family, the addresses that it connects to or listens at, the programs that it starts,
and its child processes; threads are none. The last rows are what a user asks for: a log from a server, a running viewer, and
``imuwb view``, which starts the viewer.

Command: ``python tests/studies/system_calls.py`` (3 minutes; Linux with strace).
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
import threading
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

from every_command import COMMANDS, Command, chosen, inputs, ready
from study_report import Table, main

QUESTION = "System calls of every command"
TRACED = "trace=socket,socketpair,connect,bind,listen,execve,fork,vfork,clone,clone3"
FAMILY = re.compile(r"socket\((AF_\w+)")
PLACE = re.compile(r"(?:connect|bind)\(.*?sin6?_port=htons\((\d+)\).*?inet_(?:addr|pton)\((?:AF_INET6, )?\"([^\"]+)\"")
PROGRAM = re.compile(r"execve\(\"([^\"]+)\".* = 0$")


class Quiet(SimpleHTTPRequestHandler):
    """A server of files that says nothing."""

    def log_message(self, *_: object) -> None:
        """Say nothing."""


def traced(words: list[str], folder: Path) -> tuple[int, str]:
    """Run a command under strace in a folder; return its exit code and what was traced."""
    trace = folder / ".trace"
    own = [
        sys.executable,
        "-m",
        "imuwb",
        *(Path(word).read_text() if word.endswith("/seed") else word for word in words),
    ]
    command = ["/usr/bin/strace", "-f", "--seccomp-bpf", "-e", TRACED, "-e", "signal=none", "-o", str(trace), *own]
    null = subprocess.DEVNULL
    done = subprocess.run(command, cwd=folder, stdout=null, stderr=null, check=False, timeout=300)
    return done.returncode, trace.read_text("utf-8", "replace")


def row(name: str, words: list[str], folder: Path) -> tuple[object, ...]:
    """Return the row of a command."""
    code, calls = traced(words, folder)
    lines = calls.splitlines()
    families = sorted(
        {m[1] for line in lines if (m := FAMILY.search(line))} | ({"socketpair"} if "socketpair(" in calls else set())
    )
    places = sorted({f"{m[2]}:{'PORT' if int(m[1]) > 10_000 else m[1]}" for line in lines if (m := PLACE.search(line))})
    programs = sorted({Path(m[1]).name for line in lines[1:] if (m := PROGRAM.search(line))})
    children = sum(
        bool(re.search(r"\b(?:v?fork|clone3?)\(", line)) and "CLONE_THREAD" not in line and " resumed" not in line
        for line in lines
    )
    return (name, code, *(", ".join(found) or "none" for found in (families, places, programs)), children)


def study(records: int) -> tuple[Table, ...]:
    """Trace all commands."""
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    rows = list[tuple[object, ...]]()
    with tempfile.TemporaryDirectory() as name:
        root = Path(name)
        ready()
        made = inputs(root / "in", 1)
        server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=str(made)))
        threading.Thread(target=server.serve_forever, daemon=True).start()
        asked = (
            Command("info http://...", f"info http://127.0.0.1:{server.server_port}/static.csv"),
            Command("psd --live", "psd {in}/static.mcap -o o.rrd --live"), Command("view", "view {in}/m.rrd"),
        )  # fmt: skip
        for command in (*chosen(records), *asked):
            here = root / "here"
            here.mkdir()
            rows.append(row(command.name, command.arguments(made), here))
            print(rows[-1], flush=True)
            shutil.rmtree(here)
        server.shutdown()
    headings = ("command", "exit code", "sockets", "connects to or listens at", "other programs", "child processes")
    return (Table("Calls", headings, tuple(rows), "The last three rows are what a user asks for."),)


if __name__ == "__main__":
    main(__file__, QUESTION, study, len(COMMANDS), lambda records: f"{records} commands")

"""The reference of the commands, from their own help."""

import os
import re
import subprocess
import sys
from pathlib import Path

from making.markdown import console, index

WIDTH = "100"
COMMAND = re.compile(r"^  ([a-z][a-z0-9-]*)  +\S", re.MULTILINE)  #: a line of a list of commands


def make(folder: Path) -> None:
    """Write a page for each command, with its own commands."""
    names = COMMAND.findall(help_of())
    for name in names:
        text = help_of(name)
        parts = [f"(command-{name})=\n# imuwb {name}\n", console(f"imuwb {name} --help", text)]
        if "COMMAND" in text.splitlines()[0]:
            for own in COMMAND.findall(text):
                parts += [f"\n## imuwb {name} {own}\n", console(f"imuwb {name} {own} --help", help_of(name, own))]
        (folder / f"{name}.md").write_text("\n".join(parts) + "\n", "utf-8")
    index(folder, "Commands", "Each page is the help of the command itself, as `--help` prints it.", names)


def help_of(*names: str) -> str:
    """Return what ``--help`` of a command prints."""
    environment = {**os.environ, "COLUMNS": WIDTH, "NO_COLOR": "1", "TERM": "dumb"}
    done = subprocess.run(  # noqa: S603 - imuwb itself
        [sys.executable, "-P", "-m", "imuwb", *names, "--help"],
        capture_output=True,
        text=True,
        env=environment,
        check=True,
    )
    return done.stdout

"""imuwb view: opens a recording in the Rerun viewer."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Annotated

import typer

from imuwb.errors import ImuwbError, UnreadableLogError


def view(
    recording: Annotated[
        Path, typer.Argument(help="Recording that imuwb wrote.", metavar="REC.rrd", rich_help_panel="The recording")
    ],
) -> None:
    """Open a recording in the Rerun viewer on this machine.

    Example: imuwb view static.rrd
    """
    check_recording(recording)
    # With CI the viewer sends no usage statistics; there is no option for this.
    environment = {**os.environ, "CI": "true"}
    # With -P no module of the current folder is imported in place of the viewer's.
    command = [sys.executable, "-P", "-m", "rerun", str(recording), "--bind", "127.0.0.1"]
    done = subprocess.run(command, env=environment, check=False)  # noqa: S603 - our own interpreter, a checked file
    if done.returncode:
        raise ImuwbError(f"the viewer ended with exit code {done.returncode}; run it on a machine with a screen")


def check_recording(path: Path) -> None:
    """Raise UnreadableLogError unless a file is a complete Rerun recording."""
    from imuwb.readers.bytes import source  # noqa: PLC0415 - help must not wait
    from imuwb.renames import settle  # noqa: PLC0415
    from imuwb.review.recording.rrd import MAGIC, is_whole  # noqa: PLC0415

    settle(path)
    source.check(path)
    with path.open("rb") as file:
        magic = file.read(len(MAGIC))
    if magic != MAGIC:
        raise UnreadableLogError(
            f"{path}: not a Rerun recording (the file begins with {magic!r}); imuwb writes recordings with --output FILE.rrd"
        )
    if not is_whole(path):
        raise UnreadableLogError(
            f"{path}: the recording is cut or damaged: its end mark is missing; run the analysis again"
        )

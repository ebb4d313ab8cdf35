"""The last fault of imuwb itself on this machine, kept for ``imuwb bug-report``: where it came from, and nothing of the log."""

import contextlib
import getpass
import json
import os
import re
import sys
import traceback
from collections.abc import Sequence
from pathlib import Path

ENVIRONMENT = "IMUWB_LAST_FAULT"  #: another file for it
_QUOTED = re.compile(r"'[^'\n]*'|\"[^\"\n]*\"")
_NUMBER = re.compile(r"(?<![\w.])[-+]?\d[\d_.,]*(?:[eE][-+]?\d+)?")
_FOLDERS = re.compile(r"(?:[A-Za-z]:)?(?:[^\s'\":;,|()\[\]{}<>=]*[\\/])+([^\s'\":;,|()\[\]{}<>=\\/]*)")
SHORTEST = 3  #: letters of a user's name that are looked for


def place() -> Path:
    """Return the file that the last fault is kept in: in the user's folder for what may be deleted."""
    stated = os.environ.get(ENVIRONMENT)
    if stated:
        return Path(stated)
    folder = os.environ.get("LOCALAPPDATA") or os.environ.get("XDG_CACHE_HOME")
    return (Path(folder) if folder else Path.home() / ".cache") / "imuwb" / "last-fault.json"


def remember(error: Exception, arguments: Sequence[str]) -> None:
    """Keep a fault: kind, place in the code, command and names of options. What cannot be written is not kept."""
    from imuwb import __version__  # noqa: PLC0415 - only for a fault

    frames = [f"{_module_of(f.filename)}:{f.lineno} {f.name}" for f in traceback.extract_tb(error.__traceback__)]
    words = [word.partition("=")[0] for word in arguments if word.startswith("--")]
    fault = {
        "imuwb": __version__,
        "command": arguments[0] if arguments and arguments[0].isidentifier() else "",
        "options": words,
        "kind": type(error).__name__,
        "message": masked(str(error)),
        "frames": frames,
    }
    try:
        file = place()
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(json.dumps(fault, indent=1), "utf-8")
    except (OSError, RuntimeError):
        return


def last_fault() -> object:
    """Return the fault that was kept; None without one."""
    try:
        return json.loads(place().read_text("utf-8"))
    except (OSError, ValueError, RuntimeError):
        return None


def masked(message: str) -> str:
    """Return a message of a library without what may be of a log: numbers, what stands between quotes, and folders."""
    return _NUMBER.sub("#", _QUOTED.sub("'...'", without_names(_FOLDERS.sub(lambda found: found[1] or "...", message))))


def without_names(text: str, folders: Sequence[str] = ()) -> str:
    """Return a text without some folders before names of files, and in which neither the user nor the machine is named."""
    for folder in sorted(folders, key=len, reverse=True):
        text = text.replace(folder, "")
    for name in _own_names():
        text = re.sub(rf"(?<!\w){re.escape(name)}(?!\w)", "...", text)
    return text


def _own_names() -> list[str]:
    names: list[str] = [Path.home().name, os.environ.get("HOSTNAME", ""), os.environ.get("COMPUTERNAME", "")]
    with contextlib.suppress(KeyError, OSError, ImportError):  # a user without a name
        names.append(getpass.getuser())
    return [name for name in dict.fromkeys(names) if len(name) >= SHORTEST and name != "imuwb"]


def _module_of(filename: str) -> str:
    """Return where a file lies below the nearest folder from which Python imports."""
    file = Path(filename)
    known = [Path(folder) for folder in sys.path if folder and file.is_relative_to(folder)]
    inside = max(known, key=lambda folder: len(folder.parts), default=None)
    return file.name if inside is None else file.relative_to(inside).as_posix()

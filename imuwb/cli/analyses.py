"""Analyses on the command line: by their names, and their errors."""

import errno
import os
import traceback
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, cast

from imuwb import registry
from imuwb.analysis import Analysis
from imuwb.errors import ImuwbError, UsageError

OF_THE_MACHINE = (errno.EMFILE, errno.ENFILE, errno.ENOSPC)  #: no fault of the plugin that meets them


def analysis_named(name: str) -> Analysis:
    """Return an analysis by its name on the command line, with its method if it has several, or from its file.

    Raises:
        UsageError: there is no such analysis.
    """
    if name.endswith(".py"):
        return cast("Analysis", registry.load_file(Path(name)))
    points = registry.installed(registry.ANALYSES)
    first, _, method = name.partition(" ")
    plugin: Any = registry.load(points[first]) if first in points else None
    if plugin is None:
        raise UsageError(
            f"there is no analysis {first!r}; there are {', '.join(points)}, or the path of a plugin's file"
        )
    methods = cast("Mapping[str, Analysis] | None", getattr(plugin, "METHODS", None))
    if methods is None and not method:
        return cast("Analysis", plugin)
    if not methods or method not in methods:
        known = ", ".join(f"{first} {one}" for one in methods or ()) or first
        raise UsageError(f"there is no analysis {name!r}; write {known}")
    return methods[method]


@contextmanager
def errors_named(name: str, plugin: object, kind: str = "analysis") -> Generator[None]:
    """Raise ImuwbError with the plugin's name and its line in place of an error that imuwb did not raise on purpose."""
    try:
        yield
    except (ImuwbError, MemoryError):
        raise
    except (Exception, SystemExit) as error:  # an exit of the plugin would look like a command that is done
        if isinstance(error, OSError) and error.errno in OF_THE_MACHINE:
            raise
        if os.environ.get("IMUWB_TRACEBACK") and isinstance(error, Exception):
            raise
        home = str(Path(getattr(plugin, "__file__", "") or "").parent)
        inside = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename.startswith(home)]
        where = f"{inside[-1].filename}, line {inside[-1].lineno}" if inside and home else "outside its own code"
        raise ImuwbError(
            f"{kind} {name} failed: {type(error).__name__}: {error} ({where}); "
            "set IMUWB_TRACEBACK=1 to see the whole traceback"
        ) from error

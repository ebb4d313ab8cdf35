"""Finds readers, conditioners and analyses: by entry point, or in one Python file.

imuwb's own are registered as a stranger's are. One that fails to import is a warning that names
it; two of one name are an error that names both.
"""

from __future__ import annotations

import importlib.util
import sys
import warnings
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from typing import TYPE_CHECKING

from imuwb.errors import UsageError

if TYPE_CHECKING:
    from pathlib import Path
    from types import ModuleType

READERS = "imuwb.readers"
ANALYSES = "imuwb.analyses"
CONDITIONERS = "imuwb.conditioners"


class PluginWarning(UserWarning):
    """A plugin is installed, but cannot be used."""


@cache
def installed(group: str) -> dict[str, EntryPoint]:
    """Return {name: entry point} of a group, nothing imported yet.

    Raises:
        UsageError: two distributions register the same name.
    """
    found: dict[str, EntryPoint] = {}
    for point in entry_points(group=group):
        other = found.setdefault(point.name, point)
        if other.value != point.value:
            message = (
                f"two plugins are called {point.name!r} in {group}: {_origin(other)} and {_origin(point)}; "
                "uninstall one of them"
            )
            raise UsageError(message)
    return dict(sorted(found.items()))


def load(point: EntryPoint) -> object | None:
    """Return what an entry point names; None, with a warning that names it, when it cannot be imported."""
    try:
        return point.load()
    except Exception as error:  # noqa: BLE001 - a stranger's module may raise anything, and must not stop ours
        message = f"plugin {_origin(point)} is left out: {type(error).__name__}: {error}"
        warnings.warn(message, PluginWarning, stacklevel=2)
        return None


def marked(group: str, mark: str, value: object) -> tuple[str, object] | None:
    """Return the name and the first plugin of a group that has an attribute of that value; None if no plugin has."""
    for name, point in installed(group).items():
        plugin = load(point)
        if getattr(plugin, mark, None) == value:
            return name, plugin
    return None


def summary_of(plugin: object) -> str:
    """Return the first line of a plugin's docstring."""
    lines = (getattr(plugin, "__doc__", None) or "").strip().splitlines()
    return lines[0] if lines else "no description"


def load_file(path: Path) -> ModuleType:
    """Import one Python file as a plugin and return its module.

    Raises:
        UsageError: there is no such file, or it does not run.
    """
    if not path.is_file():
        message = f"{path}: no such plugin file"
        raise UsageError(message)
    name = f"imuwb_file_plugin_{path.stem}"
    specification = importlib.util.spec_from_file_location(name, path)
    if specification is None or specification.loader is None:
        message = f"{path}: not a Python file; a plugin is a .py file"
        raise UsageError(message)
    module = importlib.util.module_from_spec(specification)
    # Before it runs: dataclasses look their own module up by name.
    sys.modules[name] = module
    try:
        specification.loader.exec_module(module)
    except SyntaxError as error:
        message = f"{path}, line {error.lineno or '?'}: {error.msg}; the plugin is not valid Python"
        raise UsageError(message) from error
    except (Exception, SystemExit) as error:
        message = f"{path}: the plugin fails on import: {type(error).__name__}: {error}"
        raise UsageError(message) from error
    return module


def _origin(point: EntryPoint) -> str:
    distribution = point.dist.name if point.dist is not None else "an unknown distribution"
    return f"{point.name!r} ({point.value}, from {distribution})"

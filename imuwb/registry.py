"""Finds readers, conditioners and analyses by entry point, or in one Python file.

The plugins of imuwb are registered like those of any other package. A plugin that fails to import gives a warning that names it.
Two plugins of the same name are an error that names both.
"""

import importlib.util
import sys
import warnings
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from types import ModuleType

from imuwb.errors import UsageError

READERS = "imuwb.readers"
ANALYSES = "imuwb.analyses"
CONDITIONERS = "imuwb.conditioners"


class PluginWarning(UserWarning):
    """A plugin is installed, but cannot be used."""


@cache
def installed(group: str) -> dict[str, EntryPoint]:
    """Return {name: entry point} of a group, without importing anything.

    Raises:
        UsageError: two packages register the same name.
    """
    points: dict[str, EntryPoint] = {}
    for point in entry_points(group=group):
        other = points.setdefault(point.name, point)
        if other.value != point.value:
            raise UsageError(
                f"two plugins of {group} have the name {point.name!r}: {_origin(other)} and {_origin(point)}; "
                "uninstall one of the packages"
            )
    return dict(sorted(points.items()))


def load(point: EntryPoint) -> object | None:
    """Return the plugin of an entry point; None, with a warning that names it, if it cannot be imported."""
    try:
        return point.load()
    except (Exception, SystemExit) as error:  # noqa: BLE001 - the module of another package may raise anything
        message = f"plugin {_origin(point)} cannot be imported: {type(error).__name__}: {error}"
        warnings.warn(message, PluginWarning, stacklevel=2)
        return None


def marked(group: str, mark: str, value: object) -> tuple[str, object] | None:
    """Return the name and the first plugin of a group that has an attribute with that value; None if there is no such plugin."""
    for name, point in installed(group).items():
        plugin = load(point)
        if getattr(plugin, mark, None) == value:
            return name, plugin
    return None


def summary_of(plugin: object) -> str:
    """Return the first line of a plugin's docstring."""
    lines = (getattr(plugin, "__doc__", None) or "").strip().splitlines()
    return lines[0] if lines else "no description"


def load_file(path: str | Path) -> ModuleType:
    """Import one Python file as a plugin, and return its module.

    Raises:
        UsageError: there is no such file, or it cannot be imported.
    """
    path = Path(path)
    if path.is_dir():
        raise UsageError(f"{path}: this is a folder; give the file of a plugin in it")
    if not path.is_file():
        raise UsageError(f"{path}: there is no such file; give the path of a plugin")
    name = f"imuwb_file_plugin_{path.stem}"
    specification = importlib.util.spec_from_file_location(name, path)
    if specification is None or specification.loader is None:
        raise UsageError(f"{path}: this is not a Python file; the name of a plugin must end in .py")
    module = importlib.util.module_from_spec(specification)
    # Dataclasses look up their module by its name while it is imported.
    sys.modules[name] = module
    try:
        specification.loader.exec_module(module)
    except SyntaxError as error:
        where = f"{path}, line {error.lineno}" if error.lineno else f"{path}"
        raise UsageError(f"{where}: {error.msg}; the plugin must be valid Python, in UTF-8") from error
    except (Exception, SystemExit) as error:
        raise UsageError(f"{path}: the import of the plugin fails: {type(error).__name__}: {error}") from error
    return module


def _origin(point: EntryPoint) -> str:
    distribution = point.dist.name if point.dist is not None else "an unknown package"
    return f"{point.name!r} ({point.value}, from {distribution})"

"""imuwb: a workbench for inertial logs.

``imuwb.read(path)`` gives a Log; ``imuwb.identification`` and its neighbours take its arrays. Names
are imported when they are first used, so that ``import imuwb`` costs nothing.
"""

from __future__ import annotations

from importlib import import_module
from importlib.metadata import version
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from imuwb import (
        analysis,
        conditioning,
        errors,
        health,
        identification,
        log,
        navigation,
        progress,
        readers,
        replay,
        simulation,
        stochastic,
        units,
        writers,
    )
    from imuwb.log import Log
    from imuwb.readers import describe, read
    from imuwb.selection import select
    from imuwb.stochastic import ImuErrorModel

__all__ = [
    "ImuErrorModel",
    "Log",
    "analysis",
    "conditioning",
    "describe",
    "errors",
    "health",
    "identification",
    "log",
    "navigation",
    "progress",
    "read",
    "readers",
    "replay",
    "select",
    "simulation",
    "stochastic",
    "units",
    "writers",
]

__version__ = version("imuwb")

_HOMES = {
    "Log": "imuwb.log",
    "ImuErrorModel": "imuwb.stochastic",
    "read": "imuwb.readers",
    "describe": "imuwb.readers",
    "select": "imuwb.selection",
}


def __getattr__(name: str) -> object:
    if name in _HOMES:
        return getattr(import_module(_HOMES[name]), name)
    if name in __all__:
        return import_module(f"imuwb.{name}")
    message = f"module 'imuwb' has no attribute {name!r}"
    raise AttributeError(message)


def __dir__() -> list[str]:
    return sorted(__all__)

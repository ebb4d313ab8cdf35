"""Navigation on the Earth: mechanization, error states, filter and outages. Names are imported when they are first used."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from imuwb.navigation.filter import Solution, solve
    from imuwb.navigation.filter_model import Aids, FilterModel, Installation, Settings
    from imuwb.navigation.outages import Drift, drift
    from imuwb.navigation.strapdown import mechanize, navigation_state

__all__ = [
    "Aids",
    "Drift",
    "FilterModel",
    "Installation",
    "Settings",
    "Solution",
    "drift",
    "mechanize",
    "navigation_state",
    "solve",
]

_HOMES = {
    "filter": ("Solution", "solve"),
    "filter_model": ("Aids", "FilterModel", "Installation", "Settings"),
    "outages": ("Drift", "drift"),
    "strapdown": ("mechanize", "navigation_state"),
}


def __getattr__(name: str) -> object:
    for module, names in _HOMES.items():
        if name in names:
            return getattr(import_module(f"imuwb.navigation.{module}"), name)
    message = f"module 'imuwb.navigation' has no attribute {name!r}"
    raise AttributeError(message)


def __dir__() -> list[str]:
    return sorted(__all__)

"""Checks that every process makes of its parameters."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np


def as_floats(process: Any) -> None:  # noqa: ANN401 - any of the processes
    """Make whole numbers floats, so that 1 and 1.0 are the same process in every respect."""
    for f in fields(process):
        if isinstance(value := getattr(process, f.name), int):
            object.__setattr__(process, f.name, float(value))


def require(what: str, value: float, *, above: float | None = None) -> None:
    """Raise ValueError unless ``value`` is finite and not negative (or greater than ``above``)."""
    if not np.isfinite(value) or value < 0 or (above is not None and value <= above):
        message = f"{what} is {value}; it must be {'positive' if above is not None else '0 or more'}"
        raise ValueError(message)

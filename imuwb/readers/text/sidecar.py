"""``LOG.toml`` beside a text log: what the log does not say itself."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

from imuwb.errors import UsageError

if TYPE_CHECKING:
    from pathlib import Path

    from imuwb.readers.batch import ReadOptions

#: key -> what its value must be
_KEYS = {
    "rate": "a number of Hz",
    "columns": "a list of names",
    "units": 'a table such as { gyro = "deg/s" }',
    "frame": '"FRD" or "FLU"',
    "epoch": '"unix" (UTC), "boot" (power-up) or "log" (its start)',
}


def with_sidecar(path: Path, options: ReadOptions) -> tuple[ReadOptions, str]:
    """Return the options with what the log's sidecar says where they are silent, and a note of what it says.

    Raises:
        UsageError: the sidecar is not TOML, or a key or its value is not one of a sidecar's.
    """
    for sidecar in (path.with_name(f"{path.name}.toml"), path.with_name(f"{path.name.split('.')[0]}.toml")):
        if sidecar.is_file():
            said = _checked(sidecar)
            return replace(
                options,
                rate=options.rate or said.get("rate"),
                columns=options.columns or tuple(said.get("columns", ())),
                units={**said.get("units", {}), **options.units},
                frame=options.frame or said.get("frame"),
                epoch=options.epoch or said.get("epoch"),
            ), f"{', '.join(said) or 'nothing'} as {sidecar.name} says"
    return options, ""


def _checked(sidecar: Path) -> dict[str, Any]:
    try:
        said = tomllib.loads(sidecar.read_text("utf-8"))
    except (OSError, tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        message = f"{sidecar}: the log's sidecar is not TOML: {error}"
        raise UsageError(message) from error
    for key, value in said.items():
        if key not in _KEYS:
            message = f"{sidecar}: unknown key {key!r}; a sidecar has {', '.join(_KEYS)}"
            raise UsageError(message)
        if not _fits(key, value):
            message = f"{sidecar}: {key} is {value!r}; it must be {_KEYS[key]}"
            raise UsageError(message)
    return said


def _fits(key: str, value: object) -> bool:
    if key == "rate":
        return isinstance(value, int | float) and not isinstance(value, bool)
    if key in ("frame", "epoch"):
        return isinstance(value, str)
    if key == "columns":
        return isinstance(value, list) and all(isinstance(name, str) for name in cast("list[object]", value))
    return isinstance(value, dict) and all(isinstance(unit, str) for unit in cast("dict[str, object]", value).values())

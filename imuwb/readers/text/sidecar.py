"""Reads the sidecar ``LOG.toml`` beside a text log; it states what the log itself does not."""

import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

from imuwb.errors import UsageError
from imuwb.notes import Note
from imuwb.readers.batch import Remark, simulated
from imuwb.readers.read_options import ReadOptions

#: key -> the rule for its value
_KEYS = {
    "rate": "a number (Hz)",
    "columns": "a list of names",
    "units": 'a table such as { gyro = "deg/s" }',
    "frame": '"FRD" or "FLU"',
    "simulated": "a table of texts",
    "epoch": '"unix" (1970 UTC), "boot" (power-up) or "log" (the log\'s start)',
}


def with_sidecar(path: Path, options: ReadOptions) -> tuple[ReadOptions, tuple[Remark, ...]]:
    """Return the options, completed by the log's sidecar, and remarks on what the sidecar states.

    An option that is set overrides the sidecar.

    Raises:
        UsageError: the sidecar is not TOML, or has an unknown key or a wrong value.
    """
    for sidecar in (path.with_name(f"{path.name}.toml"), path.with_name(f"{path.name.split('.')[0]}.toml")):
        if not sidecar.is_file():
            continue
        stated = _checked(sidecar)
        try:
            completed = replace(
                options,
                rate=options.rate or stated.get("rate"),
                columns=options.columns or tuple(stated.get("columns", ())),
                units={**stated.get("units", {}), **options.units},
                frame=options.frame or stated.get("frame"),
                epoch=options.epoch or stated.get("epoch"),
            )
        except UsageError as error:
            raise UsageError(f"{sidecar}: {error}") from error
        note = Note("sidecar", f"{sidecar.name} states {', '.join(stated) or 'nothing'}")
        truth = stated.get("simulated")
        return completed, (Remark(note), *([simulated(truth)] if truth else ()))
    return options, ()


def _checked(sidecar: Path) -> dict[str, Any]:
    try:
        stated = tomllib.loads(sidecar.read_text("utf-8"))
    except (OSError, tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise UsageError(f"{sidecar}: the log's sidecar is not valid TOML: {error}") from error
    for key, value in stated.items():
        if key not in _KEYS:
            raise UsageError(f"{sidecar}: unknown key {key!r}; a sidecar may have {', '.join(_KEYS)}")
        if not _has_type(key, value):
            raise UsageError(f"{sidecar}: {key} is {value!r}; it must be {_KEYS[key]}")
    return stated


def _has_type(key: str, value: object) -> bool:
    if key == "rate":
        return isinstance(value, int | float) and not isinstance(value, bool)
    if key in ("frame", "epoch"):
        return isinstance(value, str)
    if key == "columns":
        return isinstance(value, list) and all(isinstance(name, str) for name in cast("list[object]", value))
    return isinstance(value, dict) and all(isinstance(unit, str) for unit in cast("dict[str, object]", value).values())

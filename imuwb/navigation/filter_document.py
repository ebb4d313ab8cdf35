"""A filter as a TOML document: its error model, how it is set, and how the sensors sit in the vehicle."""

from __future__ import annotations

import math
import tomllib
from dataclasses import asdict, fields
from typing import TYPE_CHECKING, Any, cast

import tomli_w

from imuwb.errors import UsageError
from imuwb.navigation.filter_model import Aids, FilterModel, Installation, Settings
from imuwb.stochastic import ImuErrorModel

if TYPE_CHECKING:
    from pathlib import Path

SCHEMA = 1
READINGS = ("corrected", "as printed")
PARTS: dict[str, type[Any]] = {"installation": Installation, "settings": Settings, "aids": Aids}
AXES, DEEPEST = 6, 30  #: of denoising


def write_filter(model: FilterModel) -> str:
    """Return a filter as text."""
    document: dict[str, object] = {
        "schema": SCHEMA, "filter": model.name, "reading": model.reading, "scale_factor": list(model.scale_factor),
        "wavelet_levels": list(model.wavelet_levels),
    }  # fmt: skip
    document |= {part: asdict(getattr(model, part)) for part in PARTS}
    document["error_model"] = tomllib.loads(model.error_model.to_toml())
    return tomli_w.dumps(document)


def read_filter(path: Path) -> FilterModel:
    """Return the filter in a file.

    Raises:
        UsageError: the file cannot be read, or is no filter; the message says what and where.
    """
    try:
        document = tomllib.loads(path.read_text("utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        message = f"{path}: cannot be read as a filter: {error}"
        raise UsageError(message) from error
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        message = f"{path}: not TOML: {error}"
        raise UsageError(message) from error
    if document.pop("schema", SCHEMA) != SCHEMA or "filter" not in document:
        message = (
            f"{path}: no filter of schema {SCHEMA} (an error model goes to --error-model); --save-filter writes one"
        )
        raise UsageError(message)
    model = document.pop("error_model", None)
    if not isinstance(model, dict):
        message = f"{path}: a filter has a table error_model"
        raise UsageError(message)
    parts = {part: _made(kind, document.pop(part, {}), f"{path}, {part}") for part, kind in PARTS.items()}
    reading = document.pop("reading", READINGS[0])
    scale = _numbers(document.pop("scale_factor", [0.0, 0.0]), 2, f"{path}, scale_factor")
    levels = document.pop("wavelet_levels", [])
    if reading not in READINGS or (
        levels and not (len(levels) == AXES and all(isinstance(n, int) and 0 <= n <= DEEPEST for n in levels))
    ):
        message = (
            f"{path}: reading is one of {', '.join(READINGS)}, wavelet_levels none or six whole numbers to {DEEPEST}"
        )
        raise UsageError(message)
    name = str(document.pop("filter"))
    if document:
        message = f"{path}: unknown {', '.join(document)}"
        raise UsageError(message)
    text = tomli_w.dumps(cast("dict[str, Any]", model))
    return FilterModel(
        name, ImuErrorModel.from_toml(text, f"{path}, error_model"), reading, (scale[0], scale[1]), tuple(levels), **parts
    )  # fmt: skip


def _made(kind: type[Any], table: object, where: str) -> Any:  # noqa: ANN401 - one of three
    if not isinstance(table, dict):
        message = f"{where}: it must be a table"
        raise UsageError(message)
    content = cast("dict[str, object]", table)
    known = {f.name: f.default for f in fields(kind)}
    if unknown := [name for name in content if name not in known]:
        message = f"{where}: unknown {', '.join(unknown)}; there are {', '.join(known)}"
        raise UsageError(message)
    values: dict[str, object] = {}
    for name, value in content.items():
        usual = known[name]
        if isinstance(usual, tuple):
            values[name] = _numbers(value, len(cast("tuple[float, ...]", usual)), f"{where}, {name}")
        elif isinstance(usual, int):
            if not isinstance(value, int) or isinstance(value, bool) or value < 1:
                message = f"{where}, {name}: {value!r} is no whole number above 0"
                raise UsageError(message)
            values[name] = value
        else:
            values[name] = _numbers([value], 1, f"{where}, {name}")[0]
    return kind(**values)


def _numbers(value: object, count: int, where: str) -> tuple[float, ...]:
    content = cast("list[object]", value) if isinstance(value, list) else []
    if len(content) != count or not all(
        isinstance(x, int | float) and not isinstance(x, bool) and math.isfinite(x) for x in content
    ):
        message = f"{where}: {value!r} is not {count} finite number{'s' if count > 1 else ''}"
        raise UsageError(message)
    return tuple(float(cast("float", x)) for x in content)

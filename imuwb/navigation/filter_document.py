"""A filter as a TOML document: its error model, its settings, and the installation of the sensors."""

import math
import tomllib
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any, cast

import tomli_w

from imuwb.errors import UsageError
from imuwb.navigation.filter_model import Aids, FilterModel, Installation, Settings, Vibration
from imuwb.stochastic import ImuErrorModel

SCHEMA = 1
READINGS = ("corrected", "as printed")
PARTS: dict[str, type[Any]] = {
    "vibration": Vibration, "installation": Installation, "settings": Settings, "aids": Aids,
}  # fmt: skip
AXES, DEEPEST = 6, 30  #: how many levels of denoising there are (one for each axis), and the largest level


def filter_text(model: FilterModel) -> str:
    """Return a filter as a TOML document."""
    document: dict[str, object] = {
        "schema": SCHEMA, "filter": model.name, "reading": model.reading, "scale_factor": list(model.scale_factor),
        "wavelet_levels": list(model.wavelet_levels),
    }  # fmt: skip
    parts = {part: asdict(getattr(model, part)) for part in PARTS}
    del parts["settings"]["known_start"]  # it holds for one log only
    document |= parts
    document["error_model"] = tomllib.loads(model.error_model.to_toml())
    return tomli_w.dumps(document)


def read_filter(path: str | Path) -> FilterModel:
    """Return the filter in a file.

    Raises:
        UsageError: the file cannot be read, or is no filter; the message states what is wrong, and where.
    """
    document = _document(path)
    model = document.pop("error_model", None)
    if not isinstance(model, dict):
        raise UsageError(f"{path}: the table error_model is missing; --save-filter writes a filter with one")
    parts = {part: _made(kind, document.pop(part, {}), f"{path}, {part}") for part, kind in PARTS.items()}
    reading = document.pop("reading", READINGS[0])
    if reading not in READINGS:
        raise UsageError(f"{path}: reading is {reading!r}; it must be one of {', '.join(READINGS)}")
    scale = _numbers(document.pop("scale_factor", [0.0, 0.0]), 2, f"{path}, scale_factor")
    levels = document.pop("wavelet_levels", [])
    if levels and not (len(levels) == AXES and all(isinstance(n, int) and 0 <= n <= DEEPEST for n in levels)):
        raise UsageError(
            f"{path}: wavelet_levels is {levels!r}; it must be empty or six whole numbers from 0 to {DEEPEST}"
        )
    name = str(document.pop("filter"))
    if document:
        raise UsageError(f"{path}: unknown {', '.join(document)}; remove it")
    error_model = ImuErrorModel.from_toml(tomli_w.dumps(cast("dict[str, Any]", model)), f"{path}, error_model")
    return FilterModel(name, error_model, reading, (scale[0], scale[1]), tuple(levels), **parts)


def _document(path: str | Path) -> dict[str, Any]:
    try:
        document = tomllib.loads(Path(path).read_text("utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        raise UsageError(f"{path}: the file cannot be read: {error}") from error
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise UsageError(f"{path}: the file is not TOML: {error}") from error
    if document.pop("schema", SCHEMA) != SCHEMA or "filter" not in document:
        raise UsageError(
            f"{path}: the file is not a filter of schema {SCHEMA}; --save-filter writes such a file; give an error model with --error-model"
        )
    return document


def _made(kind: type[Any], table: object, where: str) -> Any:  # noqa: ANN401 - one of three
    """Return a part of a filter from a table of the document."""
    if not isinstance(table, dict):
        raise UsageError(f"{where} is {table!r}; it must be a table")
    content = cast("dict[str, object]", table)
    known = {f.name: f.default for f in fields(kind)}
    if unknown := [name for name in content if name not in known]:
        raise UsageError(f"{where}: unknown {', '.join(unknown)}; it may have {', '.join(known)}")
    return kind(**{name: _value(value, known[name], f"{where}, {name}") for name, value in content.items()})


def _value(value: object, default: object, where: str) -> object:
    """Return a value of the same type as the default."""
    if isinstance(default, tuple):
        if isinstance(value, float):  # an earlier document has one factor for positions and velocities
            value = [value] * len(cast("tuple[float, ...]", default))
        return _numbers(value, len(cast("tuple[float, ...]", default)), where)
    if isinstance(default, int):
        if not isinstance(value, int) or isinstance(value, bool) or value < 1:
            raise UsageError(f"{where} is {value!r}; it must be a whole number above 0")
        return value
    return _numbers([value], 1, where)[0]


def _numbers(value: object, count: int, where: str) -> tuple[float, ...]:
    content = cast("list[object]", value) if isinstance(value, list) else []
    if len(content) != count or not all(
        isinstance(x, int | float) and not isinstance(x, bool) and math.isfinite(x) for x in content
    ):
        raise UsageError(f"{where} is {value!r}; it must be {count} finite number{'s' if count > 1 else ''}")
    return tuple(float(cast("float", x)) for x in content)

"""A filter as a TOML document: its error model, its settings, and the installation of the sensors."""

import math
import tomllib
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any, cast, get_args

import tomli_w

from imuwb.documents import document_of, number, numbers, refuse, rows, table, whole, words
from imuwb.errors import UsageError
from imuwb.navigation.filter_model import Aids, FilterModel, Installation, Settings, Vibration
from imuwb.navigation.shaping import Reading
from imuwb.stochastic import ImuErrorModel

SCHEMA = 1
READINGS = get_args(Reading)
SCALES = ("level", "first", "none")  #: of denoising
PARTS: dict[str, type[Any]] = {
    "vibration": Vibration, "installation": Installation, "settings": Settings, "aids": Aids,
}  # fmt: skip
MOST_COUNTED = 10**9  #: largest whole number of a setting
AXES, DEEPEST = 6, 30  #: how many levels of denoising there are (one for each axis), and the largest level


def filter_text(model: FilterModel) -> str:
    """Return a filter as a TOML document."""
    document: dict[str, object] = {
        "schema": SCHEMA, "filter": model.name, "reading": model.reading, "scale_factor": list(model.scale_factor),
        "wavelet_levels": list(model.wavelet_levels), "wavelet_scale": model.wavelet_scale,
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
        refuse(f"{path}, reading", reading, f"one of {', '.join(READINGS)}")
    scale = numbers(document.pop("scale_factor", [0.0, 0.0]), 2, f"{path}, scale_factor")
    levels = _levels(document.pop("wavelet_levels", []), f"{path}, wavelet_levels")
    sigma = document.pop("wavelet_scale", SCALES[0])
    if sigma not in SCALES:
        refuse(f"{path}, wavelet_scale", sigma, f"one of {', '.join(SCALES)}")
    name = words(document.pop("filter"), f"{path}, filter")
    if document:
        raise UsageError(f"{path}: unknown {', '.join(document)}; remove it")
    error_model = ImuErrorModel.of_document(table(model, f"{path}, error_model"), f"{path}, error_model")
    return FilterModel(name, error_model, cast("Reading", reading), (scale[0], scale[1]), levels, sigma, **parts)


def _levels(content: object, where: str) -> tuple[int, ...]:
    levels = rows(content, where)
    if len(levels) not in (0, AXES):
        refuse(where, content, f"empty or a list of six whole numbers from 0 to {DEEPEST}")
    return tuple(whole(level, where, 0, DEEPEST) for level in levels)


def _document(path: str | Path) -> dict[str, object]:
    document = document_of(path, "a filter")
    if document.pop("schema", SCHEMA) != SCHEMA or "filter" not in document:
        raise UsageError(
            f"{path}: the file is not a filter of schema {SCHEMA}; --save-filter writes such a file; give an error model with --error-model"
        )
    return document


def _made(kind: type[Any], stated: object, where: str) -> Any:  # noqa: ANN401 - one of three
    """Return a part of a filter from a table of the document."""
    content = table(stated, where)
    known = {f.name: f.default for f in fields(kind)}
    if unknown := [name for name in content if name not in known]:
        raise UsageError(f"{where}: unknown {', '.join(unknown)}; it may have {', '.join(known)}")
    return kind(**{name: _value(value, known[name], f"{where}, {name}") for name, value in content.items()})


def _value(value: object, default: object, where: str) -> object:
    """Return a value of the same type as the default."""
    if isinstance(default, tuple):
        if isinstance(value, float):  # an earlier document has one factor for positions and velocities
            value = [value] * len(cast("tuple[float, ...]", default))
        return numbers(value, len(cast("tuple[float, ...]", default)), where)
    if isinstance(default, int):
        return whole(value, where, 1, MOST_COUNTED)
    return number(value, where, largest=math.inf)

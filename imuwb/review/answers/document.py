"""Results as JSON: SI units, no NaN, provenance with every result."""

import hashlib
import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from types import BuiltinFunctionType, FunctionType, GeneratorType
from typing import NotRequired, TypedDict, cast

import numpy as np

from imuwb.analysis import Answer
from imuwb.log import Conditioning, Log
from imuwb.review.answers.panel import Origin, filled
from imuwb.statistics import Estimate

SCHEMA = 1
#: representations that say no more than the type and an address: of objects, functions, generators and classes
_NAMELESS = (
    object.__repr__,
    FunctionType.__repr__,
    BuiltinFunctionType.__repr__,
    GeneratorType.__repr__,
    type.__repr__,
)
#: letters that JSON need not escape: controls, and marks of no width, such as those that turn the direction of a text
_UNSHOWN = re.compile("[\x7f-\x9f\xad\u061c\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff\ufff9-\ufffb]")
RUN = 16  #: letters of the name of a run


class StepDocument(TypedDict):
    """A command that can be typed next."""

    command: str
    why: str


class AnswerDocument(TypedDict):
    """The answer of the panel: its whole table, all sentences, and what can be typed next."""

    about: str
    headings: list[str]
    rows: list[list[str]]
    sentences: list[str]
    next: list[StepDocument]
    numbers: dict[str, Estimate]


class LogDocument(TypedDict):
    """The log that was analysed, and what conditioners did to it."""

    path: str
    format: str
    hash: str
    size: int
    selection: str
    conditioning: NotRequired[list[Conditioning]]
    causal: NotRequired[bool]


class Document(TypedDict):
    """The JSON of an analysis; ``params`` and ``result`` are those of the analysis."""

    run: str
    answer: NotRequired[AnswerDocument]
    imuwb: str
    schema: int
    analysis: str
    level: float | None
    logs: list[LogDocument]
    params: dict[str, object]
    notes: list[str]
    result: object
    study: NotRequired[object]


def plain(value: object, place: str = "the value") -> object:  # noqa: PLR0911 - one return for each kind of value
    """Return a value in the types of JSON: a dataclass as an object, an array as a list, a number that is not finite as null.

    Fields of dataclasses with ``document=False`` in their metadata are left out: only figures use them. A value of another type is
    written as its text.

    Args:
        value: any value.
        place: where it stands, for errors.

    Raises:
        ValueError: a value has no text that says what it is, such as a function; the message names its place.
    """
    if is_dataclass(value) and not isinstance(value, type):
        content = {
            f.name: plain(getattr(value, f.name), f"{place}.{f.name}")
            for f in fields(value)
            if f.metadata.get("document", True)
        }
        kind = getattr(type(value), "name", None)  # a process, whose parameters alone do not identify it
        return {"process": kind, **content} if isinstance(kind, str) else content
    if isinstance(value, np.ndarray):
        return plain(value.tolist(), place)
    if isinstance(value, np.generic):
        return plain(value.item(), place)
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        pairs = cast("Mapping[object, object]", value).items()
        return {str(key): plain(item, f"{place}[{str(key)!r}]") for key, item in pairs}
    if isinstance(value, set | frozenset):  # in an order that is the same in every process
        return sorted((plain(item, place) for item in cast("set[object]", value)), key=str)
    if isinstance(value, list | tuple):
        return [plain(item, f"{place}[{i}]") for i, item in enumerate(cast("list[object]", value))]
    if value is None or isinstance(value, str | int | bool):
        return value
    if type(value).__str__ is object.__str__ and type(value).__repr__ in _NAMELESS:
        raise ValueError(
            f"{place} is of the type {type(value).__qualname__}, which JSON cannot hold; make it a number, a text, an array, or a "
            'dataclass or a mapping of these, or leave a field of a dataclass out with metadata={"document": False}'
        )
    return str(value)


def json_text(value: object) -> str:
    """Return any value as JSON text."""
    return _text(plain(value))


def _text(value: object) -> str:
    """Return plain values as JSON text; a letter that no terminal shows as it is stands as its number."""
    text = json.dumps(value, indent=1, ensure_ascii=False, allow_nan=False)
    return _UNSHOWN.sub(lambda found: f"\\u{ord(found[0]):04x}", text)


def answer_document(answer: Answer, origin: Origin) -> dict[str, object]:
    """Return the answer of the panel as JSON has it: the whole table, all sentences, and the commands that can be typed next."""
    return {
        "about": answer.about,
        "headings": list(answer.headings),
        "rows": [list(row) for row in answer.rows],
        "sentences": list(answer.sentences),
        "next": [{"command": step.command, "why": step.why} for step in filled(answer.next, origin)],
        "numbers": plain(answer.numbers, "answer.numbers"),
    }


def document(
    analysis: str,
    version: str,
    parameters: object,
    result: object,
    logs: Sequence[Log],
    notes: Sequence[str],
    study: object = None,
    answer: Mapping[str, object] | None = None,
) -> tuple[str, str]:
    """Return the JSON text of a result and its provenance, and the name of the run, which all files of the run have.

    The name is a hash of the text, so the same result of the same log has the same name.

    Args:
        analysis: name of the analysis, with the method if it has several: "calibration six-position".
        version: version of imuwb.
        parameters: parameters of the analysis, a dataclass.
        result: result of the analysis.
        logs: the logs that were analysed.
        notes: the notes that the review shows.
        study: result of a study; None: no study was run.
        answer: what the panel shows, by ``answer_document``; the paths in its commands do not change the name of the run.

    Raises:
        ValueError: a result that JSON cannot hold; the message names the field.
    """
    name, _, method = analysis.partition(" ")
    given = cast("Mapping[str, object]", plain(parameters, "parameters"))
    settings = {**({"method": method} if method else {}), **given}
    content = {
        "imuwb": version,
        "schema": SCHEMA,
        "analysis": name,
        "level": settings.get("level"),
        "logs": [_log(log) for log in logs],
        "params": settings,
        "notes": list(notes),
        "result": plain(result, "result"),
    }
    if study is not None:
        content["study"] = plain(study, "study")
    text = _text(content)
    run = hashlib.sha256(text.encode("utf-8", "replace")).hexdigest()[:RUN]
    return _text({"run": run, **({} if answer is None else {"answer": answer}), **content}), run


def _log(log: Log) -> dict[str, object]:
    content = cast("dict[str, object]", plain(log.provenance))
    if log.conditioning:
        content |= {"conditioning": plain(log.conditioning), "causal": log.causal}
    return content

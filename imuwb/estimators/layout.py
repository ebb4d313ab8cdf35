"""Fills the layout of a tool's file."""

import json
import re
from collections.abc import Mapping, Sequence
from typing import cast

from imuwb.estimators.tool import Tool
from imuwb.texts import printable

_PLACE = re.compile(r"\{([\w.:/{}-]+?)\}")
DIGITS = 10


def filled(
    tool: Tool, values: Mapping[str, tuple[float, ...] | None], head: Sequence[str], notes: Sequence[str]
) -> str:
    """Return the file: comments, then the layout with the values; a line whose value is not known is a comment.

    A layout of JSON has ``null`` in the place of such a value, and loses its key. XML loses the line.
    """
    texts = {
        key: None if value is None else tool.join.join(f"{v:.{DIGITS}g}" for v in value)
        for key, value in values.items()
    }
    if tool.form == "json":
        return _json(tool, texts, [*head, *notes])
    lines = [line for raw in tool.layout.strip("\n").splitlines() if (line := _line(tool, raw, texts)) is not None]
    first, body = _declaration(lines)
    return "\n".join([*first, *_comments(tool, [*head, *notes]), *body]) + "\n"


def _line(tool: Tool, raw: str, texts: Mapping[str, str | None]) -> str | None:
    keys = [match[1] for match in _PLACE.finditer(raw) if match[1] in texts]
    if any(texts[key] is None for key in keys):
        if tool.form == "xml":
            return None
        indent = raw[: len(raw) - len(raw.lstrip())]
        return f"{indent}{tool.comment} {_PLACE.sub(lambda found: 'NOT KNOWN' if found[1] in texts else found[0], raw.lstrip())}"
    return _PLACE.sub(lambda found: str(texts[found[1]]) if found[1] in texts else found[0], raw)


def _declaration(lines: list[str]) -> tuple[list[str], list[str]]:
    """Return the lines that must come first in a file, and the others."""
    first = [line for line in lines[:2] if line.startswith(("%YAML", "---", "<?xml"))]
    return first, lines[len(first) :]


def _comments(tool: Tool, texts: Sequence[str]) -> list[str]:
    plain = [printable(" ".join(text.split())) for text in texts]
    if tool.form == "xml":  # two hyphens end a comment
        return ["<!--", *(f"  {re.sub('-(?=-)', '- ', text)} " for text in plain), "-->"]
    return [f"{tool.comment} {text}" for text in plain]


def _json(tool: Tool, texts: Mapping[str, str | None], comments: Sequence[str]) -> str:
    layout = _PLACE.sub(lambda found: (texts[found[1]] or "null") if found[1] in texts else found[0], tool.layout)
    document = cast("dict[str, object]", _without_null(json.loads(layout)))
    return json.dumps({"comments": list(map(printable, comments))} | document, indent=2, ensure_ascii=False) + "\n"


def _without_null(value: object) -> object:
    if isinstance(value, dict):
        items = cast("dict[str, object]", value).items()
        return {key: _without_null(item) for key, item in items if item is not None}
    return value

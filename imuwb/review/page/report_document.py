"""A report as a text that a recording keeps, and back: figures with four digits, positions to a centimetre."""

import json
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import fields
from typing import Any, cast, get_args

import numpy as np

from imuwb.analysis import Answer, AxisScale, Curve, Figure, Mark, Series, Step, Table, Vertical
from imuwb.arrays import Floats
from imuwb.errors import UnreadableLogError
from imuwb.log import SECOND, Epoch
from imuwb.review.drawn.calls import Drawn, Item, Track
from imuwb.review.page.report import Report, Source, cleaned
from imuwb.scene import Span

KEPT = "page"  #: name of the text in a recording
SCHEMA = 1
DIGITS = 4  #: significant digits of a value
STEPS = 5000  #: of a range of values that can be told apart
EXACT = 2**53  #: up to it every whole number is a float
PLACES = 9  #: decimals of a position in rad: 6 mm
STYLES, SCALES = ("line", "curve", "points", "fit", "faint", "band", "bar"), get_args(AxisScale)
EPOCHS: tuple[Epoch, ...] = ("unix", "boot", "log")


def text_of(report: Report) -> str:
    """Return a report as JSON."""
    answer = report.answer
    content = {
        "schema": SCHEMA, "imuwb": report.version, "analysis": report.analysis, "command": report.command, "run": report.run,
        "sources": [_fields(source) for source in report.sources],
        "answer": {
            "about": answer.about, "aside": answer.aside, "headings": answer.headings, "rows": answer.rows,
            "sentences": answer.sentences, "next": [_fields(step) for step in answer.next],
        },
        "figure": None if report.figure is None else _written(report.figure),
        "drawn": [{"tab": one.tab, **_written(one.item)} for one in report.drawn],
    }  # fmt: skip
    return json.dumps(content, ensure_ascii=False, separators=(",", ":"), allow_nan=False)


def report_from(text: str, path: object) -> Report:
    """Return the report of a text.

    Args:
        text: that ``text_of`` made.
        path: of the recording, for errors.

    Raises:
        UnreadableLogError: the text is not of this version of imuwb, or damaged.
    """
    try:
        content = json.loads(text)
        if content["schema"] != SCHEMA:
            raise UnreadableLogError(
                f"{path}: its page has schema {content['schema']}; this imuwb reads {SCHEMA}: run the analysis again"
            )
        drawn = tuple(Drawn(str(one["tab"]), _read(one)) for one in content["drawn"])
        given = content["answer"]
        answer = Answer(
            str(given["about"]), _texts(given["headings"]), tuple(_texts(row) for row in given["rows"]), _texts(given["sentences"]),
            tuple(Step(str(step["command"]), str(step["why"])) for step in given["next"]), str(given["aside"]),
        )  # fmt: skip
        figure = None if content["figure"] is None else _figure(content["figure"])
        sources = tuple(Source(**{key: str(value) for key, value in one.items()}) for one in content["sources"])
        name, command, run, version = (str(content[key]) for key in ("analysis", "command", "run", "imuwb"))
        return cleaned(Report(name, answer, figure, drawn, sources, command, run, version))
    except (KeyError, TypeError, ValueError, IndexError, AttributeError) as error:
        raise UnreadableLogError(f"{path}: the page in this recording is damaged: run the analysis again") from error


def _fields(value: object) -> dict[str, object]:
    return {field.name: getattr(value, field.name) for field in fields(cast("Any", value))}


def _written(item: Item) -> dict[str, object]:
    """Return what was drawn in the types of JSON."""
    if isinstance(item, Figure):
        curves = [
            {
                **_fields(c),
                "x": _numbers(c.x),
                "y": _numbers(c.y),
                "lower": _numbers(c.lower),
                "upper": _numbers(c.upper),
            }
            for c in item.curves
        ]
        others = {"marks": [_fields(m) for m in item.marks], "verticals": [_fields(v) for v in item.verticals]}
        return {"kind": "figure", **_fields(item), "curves": curves, **others}
    if isinstance(item, Series):
        start = int(item.time[0]) if item.time.size else 0
        time = _numbers((item.time - start) / SECOND)
        return {
            "kind": "series",
            **_fields(item),
            "start": start,
            "time": time,
            "values": [_numbers(row) for row in item.values.T],
            "spans": [_fields(span) for span in item.spans],
        }
    if isinstance(item, Table):
        return {"kind": "table", **_fields(item)}
    if isinstance(item, Track):
        return {"kind": "track", **_fields(item), "position": np.round(item.position, PLACES).T.tolist()}
    return {"kind": "note", "text": str(item)}


def _numbers(values: Floats | None) -> list[float | None] | None:
    """Return values with as many digits as a drawing of them can show; those that are not finite as null."""
    if values is None:
        return None
    whole = np.asarray(values, float)
    finite = whole[np.isfinite(whole)]
    step = (float(np.ptp(finite)) if finite.size else 0.0) / STEPS
    return [_number(value, step) if np.isfinite(value) else None for value in whole]


def _number(value: float, step: float) -> float:
    """Return a value with four significant digits, or more if it is much larger than the step that can be seen."""
    digits = 1 + math.floor(math.log10(abs(value) / step)) if step and abs(value) > step else 0
    rounded = float(f"{value:.{min(max(digits, DIGITS), 17)}g}")
    return int(rounded) if rounded.is_integer() and abs(rounded) < EXACT else rounded


def _read(one: Mapping[str, Any]) -> Item:
    readers: dict[str, Callable[[Mapping[str, Any]], Item]] = {
        "figure": _figure, "series": _series, "table": _table, "track": _track, "note": lambda note: str(note["text"]),
    }  # fmt: skip
    return readers[one["kind"]](one)


def _figure(one: Mapping[str, Any]) -> Figure:
    curves = tuple(
        Curve(str(c["label"]), _array(c["x"]), _array(c["y"]), _color(c["color"]), _band(c["lower"]), _band(c["upper"]), _one_of(STYLES, c["style"]))
        for c in one["curves"]
    )  # fmt: skip
    marks = tuple(
        Mark(float(m["x"]), float(m["y"]), str(m["text"]), _color(m["color"]), str(m.get("value", "")))
        for m in one["marks"]
    )
    verticals = tuple(Vertical(float(v["x"]), str(v["text"]), _color(v["color"])) for v in one["verticals"])
    x_scale, y_scale = (cast("Any", _one_of(SCALES, one[key])) for key in ("x_scale", "y_scale"))
    return Figure(
        str(one["title"]), str(one["x_title"]), str(one["y_title"]), curves, marks, x_scale, y_scale, verticals,
        _limits(one["x_limits"]), _limits(one["y_limits"]), str(one.get("group", "")),
    )  # fmt: skip


def _series(one: Mapping[str, Any]) -> Series:
    time = int(one["start"]) + np.rint(_array(one["time"]) * SECOND).astype(np.int64)
    values = np.stack([_array(column) for column in one["values"]], axis=1)
    colors = tuple(_color(color) for color in one["colors"])
    spans = tuple(
        Span(int(s["begin"]), int(s["end"]), str(s["text"]), _color(s["color"])) for s in one.get("spans", ())
    )
    epoch = None if one["epoch"] is None else EPOCHS[EPOCHS.index(one["epoch"])]
    return Series(str(one["title"]), str(one["unit"]), time, values, _texts(one["names"]), colors, epoch, spans)


def _table(one: Mapping[str, Any]) -> Table:
    rows = tuple(_texts(row) for row in one["rows"])
    return Table(str(one["title"]), _texts(one["headings"]), rows, str(one["caption"]), bool(one["wide"]))


def _track(one: Mapping[str, Any]) -> Track:
    position = np.array(one["position"], float).T.reshape(-1, 3)
    return Track(str(one["name"]), position, _color(one["color"]), str(one["label"]), str(one.get("picture", "")))


def _texts(values: Iterable[object]) -> tuple[str, ...]:
    return tuple(map(str, values))


def _array(values: Sequence[float | None]) -> Floats:
    return np.array([np.nan if value is None else float(value) for value in values])


def _band(values: Sequence[float | None] | None) -> Floats | None:
    return None if values is None else _array(values)


def _color(values: Sequence[Any]) -> tuple[int, int, int]:
    r, g, b = (min(max(int(value), 0), 255) for value in values[:3])
    return r, g, b


def _limits(values: Sequence[float] | None) -> tuple[float, float] | None:
    return None if values is None else (float(values[0]), float(values[1]))


def _one_of(names: Sequence[str], value: str) -> str:
    return names[names.index(value)]

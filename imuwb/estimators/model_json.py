"""An error model as JSON, for programs: all processes, intervals and limits, SI."""

import json
from dataclasses import fields
from typing import Any, cast

from imuwb.stochastic import ImuErrorModel


def as_json(model: ImuErrorModel) -> str:
    """Return processes, intervals and limits of a model."""
    axes = {
        axis: {
            "processes": [_plain(term) for term in cast("tuple[Any, ...]", content.processes.terms)],
            "intervals": {key: list(ends) for key, ends in content.intervals.items()},
            "limits": dict(content.limits),
        }
        for axis, content in model.axes.items()
    }
    document = {
        "name": model.name, "provenance": dict(model.provenance), "doubts": list(model.doubts), "units": "SI", "axes": axes,
    }  # fmt: skip
    return json.dumps(document, indent=1, ensure_ascii=False) + "\n"


def _plain(term: Any) -> dict[str, object]:  # noqa: ANN401 - any process
    return {"process": term.name, **{f.name: getattr(term, f.name) for f in fields(term)}}

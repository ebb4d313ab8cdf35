"""The schemas by name, one for each document."""

from collections.abc import Callable, Iterator, Mapping
from typing import Any, cast

from imuwb import registry
from imuwb.analysis import Analysis, offers, takes_no_log
from imuwb.errors import UsageError
from imuwb.schemas.of_types import Schema, Schemas, hints_of
from imuwb.schemas.settings import settings_schema

DIALECT = "https://json-schema.org/draft/2020-12/schema"
ANALYSIS = "analysis-"  #: begin of the names of the documents of analyses


def schema_names() -> tuple[str, ...]:
    """Return the names of all schemas: those of fixed documents, then those of the installed analyses."""
    return (*_FIXED, *(f"{ANALYSIS}{name.replace(' ', '-')}" for name, _ in _analyses()))


def schema(name: str) -> Schema:
    """Return a JSON Schema (draft 2020-12) by its name.

    Raises:
        UsageError: there is no schema of that name.
    """
    if name in _FIXED:
        title, make = _FIXED[name]
        return {"$schema": DIALECT, "title": title, **make()}
    for one, analysis in _analyses():
        if name == f"{ANALYSIS}{one.replace(' ', '-')}":
            return {"$schema": DIALECT, "title": f"The JSON of imuwb {one}", **_analysis(one, analysis)}
    raise UsageError(f"there is no schema {name!r}; there are {', '.join(schema_names())}")


def _analyses() -> Iterator[tuple[str, Analysis]]:
    """Yield each installed analysis by its name on the command line, with its method if it has several."""
    for name, point in registry.installed(registry.ANALYSES).items():
        plugin: Any = registry.load(point)
        if plugin is None:
            continue
        methods = cast("Mapping[str, Analysis] | None", getattr(plugin, "METHODS", None))
        for method, analysis in {"": plugin}.items() if methods is None else methods.items():
            yield f"{name} {method}".strip(), analysis


def _analysis(name: str, analysis: Analysis) -> Schema:
    """Return the schema of the JSON of an analysis: its envelope, its options and its result."""
    from imuwb.review.answers.document import SCHEMA, Document  # noqa: PLC0415 - the names of schemas do not need it

    made = Schemas()
    made.of(Document)
    document = made.definitions.pop("Document")
    first, _, method = name.partition(" ")
    params = made.of(analysis.Parameters)
    key = params["$ref"].rpartition("/")[2]
    own = made.definitions[key] = {**made.definitions[key]}
    if method:
        own["properties"] = {"method": {"const": method}, **own["properties"]}
        own["required"] = ["method", *own["required"]]
    schema = {
        "description": document["description"],
        **_with(
            document,
            {
                "schema": {"const": SCHEMA},
                "analysis": {"const": first},
                "params": params,
                "result": made.any_of(_results(analysis)),
            },
        ),
        "$defs": made.definitions,
    }
    if takes_no_log(analysis):
        schema["properties"]["logs"] = {**schema["properties"]["logs"], "maxItems": 0}
    return schema


def _results(analysis: Analysis) -> Iterator[Any]:
    """Yield the types of the results: of a run, and of a comparison of IMUs if there is one."""
    plugin = cast("Any", analysis)
    yield plugin.returns() if offers(analysis, "returns") else hints_of(plugin.run).get("return", Any)
    if offers(analysis, "compare_imus"):
        yield hints_of(plugin.compare_imus).get("return", Any)


def _with(document: Schema, properties: Mapping[str, Schema]) -> Schema:
    return {**document, "properties": {**document["properties"], **properties}}


def _of(kind: Callable[[], Any]) -> Callable[[], Schema]:
    """Return a maker of the schema of one type."""

    def make() -> Schema:
        schemas = Schemas()
        name = schemas.of(kind())["$ref"].rpartition("/")[2]
        return {**schemas.definitions.pop(name), "$defs": schemas.definitions}

    return make


def _fleet_run() -> Any:  # noqa: ANN401 - a type
    from imuwb.fleet.run_state import RunState  # noqa: PLC0415 - the names of schemas do not need it

    return RunState


def _log_summary() -> Any:  # noqa: ANN401 - a type
    from imuwb.summary import LogSummary  # noqa: PLC0415 - as above

    return LogSummary


def _error_model() -> Schema:
    from imuwb.stochastic.error_model_schema import error_model_schema  # noqa: PLC0415 - as above

    return error_model_schema()


def _plugin_check() -> Schema:
    from imuwb.testing import Report  # noqa: PLC0415 - as above

    return _wrapped({"plugins": list[Report]})


def _plan() -> Schema:
    from imuwb.identification import RecordPlan  # noqa: PLC0415 - as above

    return _wrapped({"wants": dict[str, float], "plan": RecordPlan})


def _wrapped(parts: Mapping[str, Any]) -> Schema:
    """Return the schema of a document of several parts with a number of its schema."""
    schemas = Schemas()
    properties = {"schema": {"const": 1}, **{name: schemas.of(kind) for name, kind in parts.items()}}
    return {
        "type": "object", "properties": properties, "required": list(properties), "additionalProperties": False, "$defs": schemas.definitions,
    }  # fmt: skip


#: name -> title and maker
_FIXED: dict[str, tuple[str, Callable[[], Schema]]] = {
    "error-model": (
        "An error model (TOML), which imuwb ANALYSIS --save-model and imuwb model write, also that of a calibration",
        _error_model,
    ),
    "settings": ("A settings file (TOML), which --save-config writes and --config reads", settings_schema),
    "fleet-run": ("run.json of a folder of results of imuwb fleet", _of(_fleet_run)),
    "log-summary": ("The JSON of imuwb info", _of(_log_summary)),
    "plan": ("The JSON of imuwb plan", _plan),
    "plugin-check": ("The JSON of imuwb plugins check", _plugin_check),
}

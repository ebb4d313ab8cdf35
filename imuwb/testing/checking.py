"""Asks all rules of the contract of a plugin."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Literal, cast

from imuwb.analysis import Analysis, offers
from imuwb.errors import UsageError
from imuwb.readers.reading import read
from imuwb.testing.analyses import analysis_outcomes
from imuwb.testing.conditioners import conditioner_outcomes
from imuwb.testing.outcomes import Report
from imuwb.testing.readers import reader_outcomes

Kind = Literal["analysis", "conditioner", "reader"]
#: a part that only plugins of one kind have -> the kind
_MARKS: dict[str, Kind] = {"condition": "conditioner", "probe": "reader", "run": "analysis"}


def kind_of(plugin: object, name: str = "") -> Kind:
    """Return which kind of plugin a module is; ``name`` is how an error names it.

    Raises:
        UsageError: it has the parts of no kind.
    """
    for mark, kind in _MARKS.items():
        if offers(plugin, mark):
            return kind
    raise UsageError(
        f"{name or getattr(plugin, '__name__', plugin)}: this is no plugin; an analysis has run, a conditioner has condition, and a reader has probe"
    )


def check(
    plugin: object, name: str = "", *, logs: Sequence[str | Path] = (), parameters: Mapping[str, str] | None = None
) -> Report:
    """Return what each rule of the contract found: parameters, help, purity, units, odd logs, and what the kind of plugin adds.

    Args:
        plugin: a module, or any object, with the parts of an analysis, of a conditioner or of a reader.
        name: the name by which it is registered, or that of its file.
        logs: logs that it needs; of a reader, files of its format. Without them, small simulated logs are used.
        parameters: options and their values, as texts on the command line: {"length": "2"}.

    Raises:
        UsageError: the plugin is of no kind, or it is a reader and ``parameters`` are given.
        UnreadableLogError: a log cannot be read.
    """
    kind, texts = kind_of(plugin, name), dict(parameters or {})
    if kind == "reader":
        if texts:
            raise UsageError(f"{next(iter(texts))}: a reader has no options of its own; leave it out")
        return Report(name, kind, tuple(reader_outcomes(plugin, name, [Path(log) for log in logs])))
    given = [read(log) for log in logs]
    outcomes = analysis_outcomes if kind == "analysis" else conditioner_outcomes
    return Report(name, kind, tuple(outcomes(plugin, name, given, texts)))


def methods_of(plugin: object, name: str) -> dict[str, object]:
    """Return {name: plugin}; of an analysis of several methods, each of them by its name on the command line."""
    methods = cast("Mapping[str, Analysis] | None", getattr(plugin, "METHODS", None))
    return {name: plugin} if not methods else {f"{name} {method}": part for method, part in methods.items()}

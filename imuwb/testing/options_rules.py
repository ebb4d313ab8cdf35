"""Rules for the options of a plugin: how they are declared, explained and checked."""

import math
import typing
from collections.abc import Iterator, Mapping
from dataclasses import MISSING, fields, is_dataclass
from pathlib import Path
from types import UnionType
from typing import Any, Literal, cast

from imuwb.options import Option, options_of, read
from imuwb.testing.outcomes import Attempt, Outcome, attempt, outcome

LONGEST = 130  #: letters of the first line of a help; longer ones are cut in the list of commands
NUMBERS = (int, float)
PLAIN = (int, float, bool, str, Path)


def help_outcome(plugin: object) -> Outcome:
    """Return whether the plugin and each of its options are explained."""
    return outcome("help", _unexplained(plugin), "the plugin and each of its options are explained")


def _unexplained(plugin: object) -> Iterator[str]:
    first = (getattr(plugin, "__doc__", None) or "").strip().partition("\n")[0].strip()
    if not first:
        yield "there is no docstring; write what the plugin computes in one line, which is its help"
    elif len(first) > LONGEST:
        yield f"the first line of the docstring has {len(first)} letters; shorten it to {LONGEST}"
    kind = getattr(plugin, "Parameters", None)
    for option in options_of(kind) if isinstance(kind, type) and is_dataclass(kind) else ():
        if not option.help.strip():
            yield f"{option.name} has no help; write {option.name}: Annotated[..., 'what it is, with its unit']"


def parameters_outcome(plugin: object, texts: Mapping[str, str]) -> Outcome:
    """Return whether the options are a frozen dataclass that reads texts and refuses what is not allowed.

    Args:
        plugin: the plugin.
        texts: values of options that must be given.
    """
    kind = getattr(plugin, "Parameters", None)
    if not isinstance(kind, type) or not is_dataclass(kind):
        return outcome("parameters", [f"Parameters is {kind!r}; make it a dataclass"], "")
    return outcome("parameters", _faults(kind, texts), "a frozen dataclass that refuses values that are not allowed")


def _faults(kind: type, texts: Mapping[str, str]) -> Iterator[str]:
    if not cast("Any", kind).__dataclass_params__.frozen:
        yield "Parameters is not frozen; write @dataclass(frozen=True)"
    for option in options_of(kind):
        if not _known(option.kind):
            yield (
                f"{option.name} is of the type {option.kind!r}, which no text stands for; use a number, a text, a path, a Literal, a tuple, "
                "or a class with from_text, __str__ and FORMS"
            )
    base = attempt(lambda: values_of(kind, texts)).value
    if base is None:
        return  # another rule says so
    for name, value in (*_wrong_texts(kind), *_out_of_range(kind)):
        error = attempt(lambda name=name, value=value: kind(**{**base, name: value})).error
        if not isinstance(error, ValueError):
            yield f"{name}={value} is not refused; inherit from imuwb.options.Options, which raises ValueError with the reason"
        elif name not in str(error).replace("-", "_"):
            yield f"the error for {name}={value} does not name the option: {error}"


def _known(kind: Any) -> bool:  # noqa: ANN401 - a type
    """Return whether ``imuwb.options`` reads a type from a text."""
    origin, inner = typing.get_origin(kind), typing.get_args(kind)
    if origin in (typing.Union, UnionType):
        return all(_known(member) for member in inner if member is not type(None))
    if origin is tuple:
        return all(_known(member) for member in inner if member is not Ellipsis)
    if origin in (dict, Mapping):
        return _known(inner[1])
    if origin is typing.Annotated:
        return _known(inner[0])
    return origin is Literal or kind in PLAIN or (hasattr(kind, "from_text") and hasattr(kind, "FORMS"))


def _wrong_texts(kind: type) -> Iterator[tuple[str, object]]:
    """Yield the options that are numbers or words, each with a text that is none."""
    for option in options_of(kind):
        members = _members(option)
        closed = [m for m in members if m in NUMBERS or typing.get_origin(m) is Literal]
        if len(closed) == len([m for m in members if m is not type(None)]):
            yield option.name, "no-such-value"


def _out_of_range(kind: type) -> Iterator[tuple[str, object]]:
    """Yield the options that have a range, each with a number outside."""
    for option in options_of(kind):
        between = option.between
        if between is None or not any(member in NUMBERS for member in _members(option)):
            continue
        if math.isfinite(between.least):
            yield option.name, math.floor(between.least) - 1
        if math.isfinite(between.most):
            yield option.name, math.ceil(between.most) + 1


def _members(option: Option) -> tuple[Any, ...]:
    union = typing.get_origin(option.kind) in (typing.Union, UnionType)
    return typing.get_args(option.kind) if union else (option.kind,)


def values_of(kind: type, texts: Mapping[str, str]) -> dict[str, object]:
    """Return the values of options that are given as texts.

    Raises:
        ValueError: there is no such option, a text is no value of it, or an option that must be given is missing.
    """
    known = {option.name: option for option in options_of(kind)}
    if odd := [name for name in texts if name not in known]:
        raise ValueError(f"there is no option {odd[0]!r}; there are {', '.join(known) or 'none'}")
    if missing := [f.name for f in fields(cast("Any", kind)) if f.name not in texts and _required(f)]:
        raise ValueError(f"{missing[0]} must be given")
    return {name: read(known[name], text) for name, text in texts.items()}


def _required(field: Any) -> bool:  # noqa: ANN401 - of a dataclass
    return field.default is MISSING and field.default_factory is MISSING


def parameters_for(plugin: object, texts: Mapping[str, str]) -> Attempt[Any]:
    """Return the parameters with which a plugin is tested, or the error of making them."""
    kind = cast("Any", plugin).Parameters
    return attempt(lambda: kind(**values_of(kind, texts)))

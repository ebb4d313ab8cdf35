"""Options: the types of their values, how users write them as texts, and which values are allowed.

An option is a field of a frozen dataclass. Its annotation declares the type, the help, the form of the text, the range and the
group in ``--help``:

    lever_arm: Annotated[tuple[float, float, float], "from the IMU to the antenna (m)", Form("F,R,D", "0.4,0,-1.2")]
    mounting: Literal["auto"] | tuple[float, float, float]
    level: Annotated[Level, Group("Intervals")] = 0.95

``check`` turns texts into values, and refuses values that are not allowed. A dataclass calls it in ``__post_init__``, or inherits
that from ``Options``. The command line, ``--through`` and Python code all use it, so that an option means the same everywhere.

These texts stand for values: numbers; the words of a ``Literal``; ``1,2,3`` for a tuple; ``200:30,430:60`` for a tuple of pairs;
``3..8`` for a tuple of whole numbers; ``key=value,key=value`` for a mapping; an empty text for an empty tuple. A class of your own has
``from_text(text)``, which raises ValueError, ``__str__``, which returns that text, and ``FORMS``, which describes the text.
"""

import math
import re
import types
import typing
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias, cast

MOST = 10_000  #: largest number of whole numbers in a range


@dataclass(frozen=True, slots=True)
class Between:
    """A range of allowed numbers, from ``least`` to ``most``; an open end does not belong to the range."""

    least: float = -math.inf
    most: float = math.inf
    open_least: bool = False
    open_most: bool = False

    def __contains__(self, value: float) -> bool:
        """Return whether a number is allowed; infinite numbers and nan are not."""
        above = value > self.least if self.open_least else value >= self.least
        below = value < self.most if self.open_most else value <= self.most
        return math.isfinite(value) and above and below

    def __str__(self) -> str:
        """Return the rule in words that follow "must be"."""
        least = (
            "" if math.isinf(self.least) else f"above {self.least:g}" if self.open_least else f"{self.least:g} or more"
        )
        most = "" if math.isinf(self.most) else f"below {self.most:g}" if self.open_most else f"{self.most:g} or less"
        return " and ".join(part for part in (least, most) if part) or "a finite number"


POSITIVE = Between(0.0, open_least=True)
NOT_NEGATIVE = Between(0.0)


@dataclass(frozen=True, slots=True)
class Form:
    """The text of an option: its pattern for ``--help``, an example for errors, and what a shell offers."""

    pattern: str
    example: str = ""
    words: tuple[str, ...] | Callable[[], Iterable[str]] = ()  #: that may stand in the text, or what returns them
    streams: str = ""  #: kind of streams (``imuwb.log.Kind``) of the log whose names may stand in the text


@dataclass(frozen=True, slots=True)
class Group:
    """The group of an option in ``--help``."""

    title: str


#: Probability with which an interval contains the truth. At one half, a one-sided limit would be the estimate itself.
Level: TypeAlias = Annotated[float, "level of all intervals and limits", Between(0.6, 1.0, open_most=True)]


@dataclass(frozen=True, slots=True)
class Option:
    """One field of a dataclass of options, as its annotation declares it."""

    name: str
    kind: Any  #: the type, without the metadata of ``Annotated``
    help: str = ""
    between: Between | None = None
    form: Form | None = None
    group: str = ""  #: in ``--help``; empty: that of all options of the dataclass

    @property
    def unit(self) -> str:
        """Return the unit in brackets at the end of the help: Hz; empty: there is none."""
        found = re.search(r"\(([^\s()]+)\)\.?$", self.help)
        return found[1] if found else ""


def options_of(parameters: type) -> tuple[Option, ...]:
    """Return the options that a dataclass declares, in order."""
    hints = typing.get_type_hints(parameters, include_extras=True)
    return tuple(_option(f.name, hints[f.name]) for f in fields(cast("Any", parameters)))


def _option(name: str, hint: Any) -> Option:  # noqa: ANN401 - an annotation
    if typing.get_origin(hint) is not Annotated:
        return Option(name, hint)
    kind, *metadata = typing.get_args(hint)
    metadata.reverse()  # the metadata of an alias, such as Level, come first; metadata that a field adds override them
    text = next((item for item in metadata if isinstance(item, str)), "")
    between = next((item for item in metadata if isinstance(item, Between)), None)
    form = next((item for item in metadata if isinstance(item, Form)), None)
    group = next((item.title for item in metadata if isinstance(item, Group)), "")
    return Option(name, kind, text, between, form, group)


def check(parameters: object) -> None:
    """Turn the texts in the fields of a frozen dataclass into values, and check the ranges.

    Raises:
        ValueError: a value that is not allowed; the message names the option, the value and the rule.
    """
    for option in options_of(type(parameters)):
        given = getattr(parameters, option.name)
        value = read(option, given) if isinstance(given, str) else given
        if isinstance(value, list):
            value = tuple(cast("list[object]", value))
        if option.between is not None:
            for number in _numbers(value):
                if number not in option.between:
                    open_ended = (
                        math.isinf(number) and math.isinf(option.between.most) and math.isfinite(option.between.least)
                    )
                    rule = f"{option.between}{', and finite' if open_ended else ''}"
                    raise ValueError(f"{option.name} is {text_of(value)}; it must be {rule}")
        object.__setattr__(parameters, option.name, value)


@dataclass(frozen=True)
class Options:
    """A base of dataclasses of options: it checks the values when they are given."""

    def __post_init__(self) -> None:
        """Check the values."""
        check(self)


def read(option: Option, text: str) -> Any:  # noqa: ANN401 - of the option's type
    """Return the value that a text stands for.

    Raises:
        ValueError: the text stands for no value of the option's type.
    """
    for kind in _members(option.kind):
        try:
            return _value(kind, text.strip())
        except ValueError:
            continue
    example = f", such as {option.form.example}" if option.form is not None and option.form.example else ""
    raise ValueError(f"{option.name} is {text!r}; it must be {described(option.kind)}{example}")


def _members(kind: Any) -> Iterator[Any]:  # noqa: ANN401 - a type
    """Yield the types of a union, Literals first; a type that is no union alone."""
    members = typing.get_args(kind) if typing.get_origin(kind) in (typing.Union, types.UnionType) else (kind,)
    yield from sorted((m for m in members if m is not type(None)), key=lambda m: typing.get_origin(m) is not Literal)


def words_of(kind: Any) -> Iterator[str]:  # noqa: ANN401 - a type
    """Yield the words of the Literals in a type."""
    for member in _members(kind):
        if typing.get_origin(member) is Literal:
            yield from map(str, typing.get_args(member))


def _value(kind: Any, text: str) -> Any:  # noqa: ANN401 - of the type ``kind``
    """Return the value of a type that a text stands for; ValueError if there is none."""
    origin, inner = typing.get_origin(kind), typing.get_args(kind)
    if origin is Literal:
        if text in inner:
            return text
        raise ValueError
    if origin is tuple:
        return _tuple(inner, text, ",")
    if origin in (dict, Mapping):
        return _mapping(inner[1], text)
    if kind is bool:
        if text.lower() not in _SWITCHES:
            raise ValueError
        return _SWITCHES[text.lower()]
    if kind is float:
        number = float(text)
        if math.isnan(number):
            raise ValueError
        return number
    return getattr(kind, "from_text", kind if kind in (int, str, Path) else str)(text)


def _mapping(kind: Any, text: str) -> dict[str, Any]:  # noqa: ANN401 - a type
    pairs = [part.partition("=") for part in text.split(",") if part.strip()]
    values = {key.strip(): value.strip() for key, _, value in pairs}
    if len(values) < len(pairs) or not all(values.values()):
        raise ValueError
    return {key: _value(kind, value) for key, value in values.items()}


def _tuple(inner: tuple[Any, ...], text: str, mark: str) -> tuple[Any, ...]:
    parts = [part.strip() for part in text.split(mark)] if text else []
    if inner[-1] is Ellipsis:
        kind = inner[0]
        if kind is int and ".." in text:
            return tuple(whole_numbers(text, MOST))
        if typing.get_origin(kind) is tuple:
            return tuple(_tuple(typing.get_args(kind), part, ":") for part in parts)
        return tuple(_value(kind, part) for part in parts)
    if len(parts) != len(inner):
        raise ValueError
    return tuple(_value(kind, part) for kind, part in zip(inner, parts, strict=True))


def whole_numbers(text: str, most: int) -> range:
    """Return the whole numbers of a range such as ``3..8``.

    Raises:
        ValueError: the text is no range, its second end is below the first, or it has more than ``most`` numbers.
    """
    first, _, last = text.partition("..")
    numbers = range(int(first), int(last) + 1)
    if not 0 < len(numbers) <= most:
        raise ValueError
    return numbers


UNREAL = 1 << 1023  #: a whole number beyond has no float


def _numbers(value: object) -> Iterator[float]:
    """Yield all numbers in a value."""
    if isinstance(value, Mapping):
        value = tuple(cast("Mapping[str, object]", value).values())
    if isinstance(value, tuple):
        for part in cast("tuple[object, ...]", value):
            yield from _numbers(part)
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield float(value) if abs(value) < UNREAL else math.inf if value > 0 else -math.inf


_SWITCHES = {"true": True, "yes": True, "1": True, "false": False, "no": False, "0": False}
_NAMES = {int: "a whole number", float: "a number", bool: "true or false", str: "a text", Path: "a path"}
_COUNTS = {2: "two", 3: "three", 4: "four", 6: "six"}


def described(kind: Any) -> str:  # noqa: ANN401 - a type
    """Return the texts of a type in words that follow "must be"."""
    return " or ".join(_described(member) for member in _members(kind))


def _described(kind: Any) -> str:  # noqa: ANN401 - a type
    origin, inner = typing.get_origin(kind), typing.get_args(kind)
    if origin is Literal:
        return " or ".join(str(word) for word in inner)
    if origin in (dict, Mapping):
        return "key=value,key=value"
    if origin is tuple:
        if Ellipsis not in inner:
            return f"{_COUNTS.get(len(inner), len(inner))} {_plural(inner[0])} separated by commas"
        if typing.get_origin(inner[0]) is tuple:
            return f"pairs of {_plural(typing.get_args(inner[0])[0])}, A:B,A:B"
        return f"{_plural(inner[0])} separated by commas" + (", or a range such as 3..8" if inner[0] is int else "")
    return _NAMES.get(kind) or getattr(kind, "FORMS", str(kind))


def _plural(kind: Any) -> str:  # noqa: ANN401 - a type
    return {int: "whole numbers", float: "numbers", str: "names"}.get(kind, f"values ({_described(kind)})")


def text_of(value: object) -> str:
    """Return the text that ``read`` turns into a value."""
    if isinstance(value, Mapping):
        return ",".join(f"{key}={text_of(item)}" for key, item in cast("Mapping[str, object]", value).items())
    if isinstance(value, tuple):
        parts = cast("tuple[object, ...]", value)
        return ",".join(
            ":".join(map(text_of, cast("tuple[object, ...]", p))) if isinstance(p, tuple) else text_of(p) for p in parts
        )
    return f"{value:g}" if isinstance(value, float) else str(value)

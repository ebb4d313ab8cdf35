"""Conditioners on the command line: ``--through NAME:key=value,...``."""

import inspect
import typing
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any, cast

from imuwb import registry
from imuwb.analysis import Conditioner, Review, offers
from imuwb.cli.analyses import errors_named
from imuwb.cli.parameters import default_of
from imuwb.errors import UsageError
from imuwb.log import Conditioning, Log
from imuwb.options import Option, options_of, read, text_of

SUFFIX = ".py"  #: of a conditioner that is a file
UNSTATED = "the conditioner does not state whether it is causal, nor its delay"


@dataclass(frozen=True, slots=True)
class Step:
    """One conditioner with its parameters."""

    name: str
    conditioner: Conditioner
    parameters: Any
    option: str = "--through"  #: the option that names it, for errors

    def apply(self, log: Log) -> tuple[Log, Any]:
        """Return the changed log, and the change for ``draw``. The log states the conditioner, whatever that itself has recorded.

        Raises:
            UsageError: parameters that do not suit this log.
            ImuwbError: the conditioner fails.
        """
        with errors_named(self.name, self.conditioner, "conditioner"):
            try:
                changed, change = self.conditioner.condition(log, self.parameters)
            except ValueError as error:
                raise UsageError(f"{self.option} {self.name}: {error}") from error
        return self._recorded(changed, log), change

    def _recorded(self, changed: Log, before: Log) -> Log:
        """Return the changed log with all steps before this one, and this one."""
        kept = before.conditioning
        own = changed.conditioning[len(kept) :] if changed.conditioning[: len(kept)] == kept else changed.conditioning
        if not own:
            own = (Conditioning(self.name, self._stated(), causal=False, delay=0.0, note=UNSTATED),)
        return changed if changed.conditioning == (*kept, *own) else replace(changed, conditioning=(*kept, *own))

    def _stated(self) -> str:
        """Return the parameters as they follow the name on the command line."""
        values = {f.name: getattr(self.parameters, f.name) for f in fields(self.parameters)}
        return ",".join(
            f"{name}={text_of(value).replace(',', '/')}" for name, value in values.items() if value is not None
        )

    def draw(self, applied: Any, review: Review) -> None:  # noqa: ANN401 - the conditioner's own
        """Show the change, if the conditioner can draw it."""
        if offers(self.conditioner, "draw"):
            cast("Any", self.conditioner).draw(applied, review)


def step(text: str) -> Step:
    """Return the conditioner and the parameters that ``NAME:key=value,...`` names.

    Raises:
        UsageError: an unknown conditioner or key, or a value that the parameter does not allow.
    """
    name, rest = _parted(text)
    pairs = [part.partition("=") for part in rest.split(",")] if rest else []
    for key, mark, _ in pairs:
        if not mark:
            raise UsageError(f"--through {text}: {key!r} has no value; write {name}:key=value,key=value")
    keys = [key.strip() for key, _, _ in pairs]
    twice = {key for key in keys if keys.count(key) > 1}
    if twice:
        raise UsageError(f"--through {text}: {', '.join(sorted(twice))} is given twice; give each key once")
    return step_of(name.strip(), {key.strip(): value.strip() for key, _, value in pairs})


def _parted(text: str) -> tuple[str, str]:
    """Return the name of a conditioner, and what follows it; a file may have a colon in its path."""
    file, suffix, rest = text.partition(SUFFIX)
    if suffix and rest[:1] in ("", ":"):
        return file + suffix, rest[1:]
    name, _, rest = text.partition(":")
    return name, rest


def step_of(name: str, values: Mapping[str, str], option: str = "--through") -> Step:
    """Return a conditioner with parameters given as texts; ``/`` separates the numbers of one parameter.

    Args:
        name: name of the conditioner.
        values: {parameter: text}.
        option: the option of the command line that names the conditioner, for errors.

    Raises:
        UsageError: an unknown conditioner or key, or a value that the parameter does not allow.
    """
    conditioner = conditioner_of(name, option)
    kind = conditioner.Parameters
    options = {option.name: option for option in options_of(kind)}
    for key in values:
        if key not in options:
            raise UsageError(f"{option} {name}: there is no parameter {key!r}; there are {', '.join(options)}")
    missing = [f.name for f in fields(kind) if f.name not in values and default_of(f) is inspect.Parameter.empty]
    if missing:
        mark = ":" if option == "--through" else "."
        raise UsageError(f"{option} {name}: {', '.join(missing)} must be given; write {name}{mark}{missing[0]}=...")
    try:
        parameters = kind(**{key: _value(options[key], text) for key, text in values.items()})
    except ValueError as error:
        raise UsageError(f"{option} {name}: {error}") from error
    return Step(Path(name).stem if name.endswith(SUFFIX) else name, conditioner, parameters, option)


def conditioner_of(name: str, option: str = "--through") -> Conditioner:
    """Return a conditioner by its name, or from its file.

    Raises:
        UsageError: there is no such conditioner, or it cannot be imported.
    """
    if name.endswith(SUFFIX):
        loaded = registry.load_file(name)
        if missing := [part for part in ("Parameters", "condition") if not offers(loaded, part)]:
            raise UsageError(
                f"{option} {name}: a conditioner must have Parameters and condition; it lacks {missing[0]}"
            )
        return cast("Conditioner", loaded)
    points = registry.installed(registry.CONDITIONERS)
    if name not in points:
        raise UsageError(
            f"{option} {name}: there is no such conditioner; there are {', '.join(points)}, or the path of a file"
        )
    conditioner = registry.load(points[name])
    if conditioner is None:
        raise UsageError(f"{option} {name}: the conditioner cannot be imported; see the warning")
    return cast("Conditioner", conditioner)


def conditioners() -> Iterator[tuple[str, Conditioner]]:
    """Yield the name of each conditioner that can be imported, and the conditioner."""
    for name, point in registry.installed(registry.CONDITIONERS).items():
        conditioner = registry.load(point)
        if conditioner is not None:
            yield name, cast("Conditioner", conditioner)


def conditioned(log: Log, texts: Sequence[str]) -> tuple[Log, list[tuple[Step, Any]]]:
    """Return a log after all conditioners, in their order, and each conditioner with the change that its ``draw`` can show."""
    applied: list[tuple[Step, Any]] = []
    for text in texts:
        current = step(text)
        log, change = current.apply(log)
        applied.append((current, change))
    return log, applied


def _value(option: Option, text: str) -> Any:  # noqa: ANN401 - of the option's type
    """Return the value of a parameter. Slashes separate the numbers of a tuple, because commas separate the parameters."""
    kinds = (option.kind, *typing.get_args(option.kind))
    return read(option, text.replace("/", ",") if any(typing.get_origin(k) is tuple for k in kinds) else text)

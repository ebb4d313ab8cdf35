"""Studies on the command line: ``--study NAME.key=1,2,3`` repeats an analysis for each value of a conditioner's parameter."""

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence

from imuwb.analysis import Case
from imuwb.cli.through import Step, conditioner_of, conditioners, step_of
from imuwb.errors import UsageError
from imuwb.log import Log
from imuwb.options import options_of, whole_numbers
from imuwb.progress import tracked

MOST_CASES = 200
OPTION = "--study"


def grid(texts: Sequence[str]) -> list[dict[str, str]]:
    """Return all combinations of the values of a study, each as a setting such as {"wavelet.levels": "3"}.

    Raises:
        UsageError: a text is not a study, a value is not allowed, or there are too many combinations.
    """
    axes = [_axis(text) for text in texts]
    count = math.prod(len(values) for _, values in axes)
    if count > MOST_CASES:
        raise UsageError(f"--study: there are {count} combinations; give fewer values, for at most {MOST_CASES}")
    names = [name for name, _ in axes]
    settings = [
        dict(zip(names, combination, strict=True)) for combination in itertools.product(*(values for _, values in axes))
    ]
    for setting in settings:
        steps_of(setting)
    return settings


def _axis(text: str) -> tuple[str, list[str]]:
    """Return the name of a study, and its values."""
    name, mark, values = text.partition("=")
    name = name.strip()
    if not mark or not values or ("." not in name and name not in _short_names()):
        short = ", ".join(f"{known}=..." for known in _short_names())
        raise UsageError(f"--study {text}: write NAME.key=1,2,3 or NAME.key=1..8, or use a short name: {short}")
    return name, _values(text, values)


def _values(text: str, values: str) -> list[str]:
    if ".." not in values:
        return [value.strip() for value in values.split(",")]
    try:
        return [str(number) for number in whole_numbers(values, MOST_CASES)]
    except ValueError as error:
        raise UsageError(
            f"--study {text}: a range must be two whole numbers, the smaller one first, such as 3..8, "
            f"and contain at most {MOST_CASES}"
        ) from error


def steps_of(setting: Mapping[str, str]) -> list[Step]:
    """Return the conditioners of one setting in the order that they declare; those without an order come last."""
    parameters: dict[str, dict[str, str]] = {}
    for name, value in setting.items():
        conditioner, key, others = _meant(name)
        parameters.setdefault(conditioner, {}).update({key: value, **others})
    names = sorted(parameters, key=lambda name: getattr(conditioner_of(name, OPTION), "ORDER", math.inf))
    return [step_of(name, parameters[name], OPTION) for name in names]


def _unit(name: str) -> str:
    """Return the unit of a setting, which its conditioner declares; empty: it has none."""
    conditioner, key, _ = _meant(name)
    options = options_of(conditioner_of(conditioner, OPTION).Parameters)
    return next((option.unit for option in options if option.name == key), "")


def _meant(name: str) -> tuple[str, str, Mapping[str, str]]:
    """Return conditioner, parameter and values of other parameters of a setting; a conditioner that is a file has dots in its path."""
    short = _short_names()
    if name in short:
        return short[name]
    conditioner, _, key = name.rpartition(".")
    return conditioner, key, {}


def _short_names() -> dict[str, tuple[str, str, Mapping[str, str]]]:
    """Return {short name: (conditioner, parameter, values of other parameters)}, as the conditioners declare them.

    Raises:
        UsageError: two conditioners declare the same short name.
    """
    short: dict[str, tuple[str, str, Mapping[str, str]]] = {}
    for name, conditioner in conditioners():
        for alias, (key, others) in getattr(conditioner, "STUDY", {}).items():
            if alias in short:
                raise UsageError(
                    f"--study {alias}: the conditioners {short[alias][0]} and {name} both declare this name; remove one of them"
                )
            short[alias] = name, key, others
    return short


def cases(logs: Sequence[Log], texts: Sequence[str]) -> Iterator[Case]:
    """Yield each log in each setting; one at a time, because logs may be large.

    Raises:
        UsageError: a setting does not suit a log, such as a bandwidth above half its rate.
    """
    settings = grid(texts)
    units = {name: unit for name in settings[0] if (unit := _unit(name))} if settings else {}
    for log in tracked(logs, len(logs)):
        for setting in tracked(settings, len(settings)):
            changed = log
            for step in steps_of(setting):
                changed, _ = step.apply(changed)
            name = {"log": log.provenance.path} if len(logs) > 1 else {}
            yield Case({**name, **setting}, changed, units)

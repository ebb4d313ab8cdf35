"""Conditioners on the command line: ``NAME:key=value,...``, and studies that repeat an analysis for many values."""

from __future__ import annotations

import itertools
from dataclasses import MISSING, Field, dataclass, fields
from typing import TYPE_CHECKING, Any, cast

from imuwb import registry
from imuwb.analysis import Case, offers
from imuwb.errors import UsageError
from imuwb.options import options_of, read
from imuwb.progress import tracked

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from imuwb.analysis import Conditioner, Review
    from imuwb.log import Log

MOST_CASES = 200
#: what one says for short in a study -> conditioner, key, and keys that go with it
SHORT = {"rate": ("decimate", "rate", {"anti_alias": "false"}), "bandwidth": ("bandwidth", "cutoff", {})}
#: in this order within one case: a sensor filters, and then puts out samples
ORDER = ("bias", "bandwidth", "kaiser", "wavelet", "decimate")


@dataclass(frozen=True, slots=True)
class Step:
    """One conditioner with its parameters."""

    name: str
    conditioner: Conditioner
    parameters: Any

    def apply(self, log: Log) -> tuple[Log, Any]:
        """Return the changed log, and what can be drawn.

        Raises:
            UsageError: the parameters cannot be with this log.
        """
        try:
            return self.conditioner.condition(log, self.parameters)
        except ValueError as error:
            message = f"--through {self.name}: {error}"
            raise UsageError(message) from error

    def draw(self, found: Any, review: Review) -> None:  # noqa: ANN401 - the conditioner's own
        """Show the change, where the conditioner can."""
        if offers(self.conditioner, "draw"):
            cast("Any", self.conditioner).draw(found, review)


def step(text: str) -> Step:
    """Return the conditioner that ``NAME:key=value,...`` names.

    Raises:
        UsageError: no such conditioner or key, or a value that cannot be.
    """
    name, _, rest = text.partition(":")
    pairs = [part.partition("=") for part in rest.split(",")] if rest else []
    for key, mark, _ in pairs:
        if not mark:
            message = f"--through {text}: {key!r} has no value; write {name}:key=value,key=value"
            raise UsageError(message)
    keys = [key.strip() for key, _, _ in pairs]
    twice = {key for key in keys if keys.count(key) > 1}
    if twice:
        message = f"--through {text}: {', '.join(sorted(twice))} is given twice"
        raise UsageError(message)
    return made(name.strip(), {key.strip(): value.strip() for key, _, value in pairs})


def made(name: str, values: dict[str, str]) -> Step:
    """Return a conditioner with parameters given as texts."""
    points = registry.installed(registry.CONDITIONERS)
    if name not in points:
        message = f"--through {name}: no such conditioner; there are {', '.join(points)}"
        raise UsageError(message)
    conditioner = registry.load(points[name])
    if conditioner is None:
        message = f"--through {name}: the conditioner cannot be loaded (see the warning)"
        raise UsageError(message)
    kind = cast("Any", conditioner).Parameters
    options = {option.name: option for option in options_of(kind)}
    for key in values:
        if key not in options:
            message = f"--through {name}: no parameter {key!r}; there are {', '.join(options)}"
            raise UsageError(message)
    missing = [f.name for f in fields(kind) if f.name not in values and _required(f)]
    if missing:
        message = f"--through {name}: it needs {', '.join(missing)}; write {name}:{missing[0]}=..."
        raise UsageError(message)
    try:
        return Step(name, cast("Conditioner", conditioner), kind(**{k: read(options[k], v) for k, v in values.items()}))
    except ValueError as error:
        message = f"--through {name}: {error}"
        raise UsageError(message) from error


def _required(f: Field[Any]) -> bool:
    return f.default is MISSING and f.default_factory is MISSING


def conditioned(log: Log, texts: Sequence[str]) -> tuple[Log, list[tuple[Step, Any]]]:
    """Return the log through all conditioners, in order, and what each can draw."""
    found: list[tuple[Step, Any]] = []
    for text in texts:
        one = step(text)
        log, result = one.apply(log)
        found.append((one, result))
    return log, found


def grid(texts: Sequence[str]) -> list[dict[str, str]]:
    """Return the settings of a study, {"wavelet.levels": "3"} and so on, every combination.

    Raises:
        UsageError: a text that is no study, or too many combinations.
    """
    axes: list[tuple[str, list[str]]] = []
    for text in texts:
        name, mark, values = text.partition("=")
        if not mark or not values or ("." not in name and name not in SHORT):
            message = f"--study {text}: write NAME.key=1,2,3 or NAME.key=1..8, or rate=..., bandwidth=... (Hz)"
            raise UsageError(message)
        axes.append((name.strip(), _values(text, values)))
    cases = [
        dict(zip([n for n, _ in axes], combination, strict=True))
        for combination in itertools.product(*(v for _, v in axes))
    ]
    if len(cases) > MOST_CASES:
        message = f"--study: {len(cases)} combinations; at most {MOST_CASES} are run"
        raise UsageError(message)
    for case in cases:
        steps_of(case)
    return cases


def _values(text: str, values: str) -> list[str]:
    first, dots, last = values.partition("..")
    if not dots:
        return [value.strip() for value in values.split(",")]
    try:
        low, high = int(first), int(last)
    except ValueError as error:
        message = f"--study {text}: a range goes from one whole number to another, such as 3..8"
        raise UsageError(message) from error
    if high < low or high - low >= MOST_CASES:
        message = f"--study {text}: a range rises, by less than {MOST_CASES}"
        raise UsageError(message)
    return [str(k) for k in range(low, high + 1)]


def steps_of(case: dict[str, str]) -> list[Step]:
    """Return the conditioners of one setting, the sensor's own filter before its rate."""
    wanted: dict[str, dict[str, str]] = {}
    for name, value in case.items():
        conditioner, key, others = SHORT[name] if name in SHORT else (*name.split(".", 1), {})
        wanted.setdefault(conditioner, {}).update({key: value, **others})
    names = sorted(wanted, key=lambda name: ORDER.index(name) if name in ORDER else len(ORDER))
    return [made(name, wanted[name]) for name in names]


def cases(logs: Sequence[Log], texts: Sequence[str]) -> Iterator[Case]:
    """Yield each log in each setting, one at a time: they may be large.

    Raises:
        UsageError: a setting that a log cannot have, such as a bandwidth beyond half its rate.
    """
    settings = grid(texts)
    for log in tracked(logs, len(logs)):
        for case in tracked(settings, len(settings)):
            changed = log
            for one in steps_of(case):
                changed, _ = one.apply(changed)
            name = {"log": log.provenance.path} if len(logs) > 1 else {}
            yield Case({**name, **case}, changed)

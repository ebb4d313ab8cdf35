"""What a run has to do: a task for each log, in an order that shows results early, and the name of each task's part."""

import hashlib
import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path

from imuwb.errors import UsageError
from imuwb.fleet.identity import NOBODY, PLACES, Identity, Rule
from imuwb.fleet.listing import Listed, tag_of

BRACES = re.compile(r"\{(\w*)\}")
LARGEST = 100_000_000  #: bytes of a file that an option names, and whose content is a part of the task's name


@dataclass(frozen=True, slots=True)
class Task:
    """One log to analyse."""

    log: Listed
    identity: Identity
    values: tuple[tuple[str, object], ...]  #: of the options that have a part of the identity in braces, filled
    options: str  #: hash of ``values``, and of the files that the options name
    tag: str  #: hash of the log's tag and of ``options``
    missing: str = ""  #: part of the identity that an option needs, and that is not known


def planned(logs: Sequence[Listed], rule: Rule, values: Iterable[tuple[str, object]]) -> tuple[Task, ...]:
    """Return a task for each log, in the order of the logs.

    Args:
        logs: that were found.
        rule: states whose they are.
        values: of the options of the analysis and of the reading; texts may have ``{serial}``, ``{vehicle}`` and ``{family}``.

    Raises:
        UsageError: a path has another word in braces, or the rule says nothing of any log, does not tell some apart, or states a date that is none.
    """
    digests: dict[str, str] = {}
    values = tuple(values)
    for _, value in values:
        _check_places(value)
    rule.check(logs)
    identities = [rule.of(log) for log in logs]
    if logs and all(identity == NOBODY for identity in identities) and (text := rule.nothing(logs[0])):
        raise UsageError(text)
    return tuple(_task(log, who, values, digests) for log, who in zip(logs, identities, strict=True))


def _task(log: Listed, who: Identity, values: Sequence[tuple[str, object]], digests: dict[str, str]) -> Task:
    try:
        filled = tuple((key, _filled(value, who)) for key, value in values)
    except KeyError as error:
        options = tag_of("missing", error.args[0])
        return Task(log, who, (), options, tag_of(log.tag, options), str(error.args[0]))
    files = [_digest(text, digests) for _, value in filled for text in _texts(value)]
    own = tuple((key, value) for (key, value), (_, before) in zip(filled, values, strict=True) if value != before)
    options = tag_of(own, *files)
    return Task(log, who, own, options, tag_of(log.tag, options))


def has_place(value: object) -> bool:
    """Return whether a value has a part of the identity in braces."""
    return any(f"{{{name}}}" in text for text in _texts(value) for name in PLACES)


def _check_places(value: object) -> None:
    """Raise UsageError if a path has a word in braces that is no part of an identity."""
    for one in value if isinstance(value, list | tuple) else (value,):
        wrong = [word for word in BRACES.findall(str(one)) if word not in PLACES] if isinstance(one, Path) else []
        if wrong:
            raise UsageError(
                f"{one}: {{{wrong[0]}}} is no part of an identity; write {', '.join(f'{{{name}}}' for name in PLACES)}"
            )


def _filled(value: object, who: Identity) -> object:
    if not has_place(value):
        return value
    if isinstance(value, list | tuple):
        return tuple(_filled(one, who) for one in value)
    filled = who.filled(str(value))
    return Path(filled) if isinstance(value, Path) else filled


def _texts(value: object) -> Iterator[str]:
    if isinstance(value, str | Path):
        yield str(value)
    elif isinstance(value, list | tuple):
        for one in value:
            yield from _texts(one)


def _digest(text: str, digests: dict[str, str]) -> str:
    """Return a hash of the file that a text names; empty for another text."""
    if text not in digests:
        path = Path(text)
        try:
            known = path.is_file() and path.stat().st_size <= LARGEST
            digests[text] = hashlib.sha256(path.read_bytes()).hexdigest() if known else ""
        except (OSError, ValueError):
            digests[text] = ""
    return digests[text]


def ordered(tasks: Iterable[Task]) -> list[Task]:
    """Return tasks in an order that shows results early: the smallest log of each sensor, then the second of each, and so on."""
    groups: dict[Identity, list[Task]] = defaultdict(list)
    for task in tasks:
        who = task.identity
        groups[Identity(who.vehicle, who.serial, who.family)].append(task)
    for group in groups.values():
        group.sort(key=lambda task: (task.log.size, task.log.place))
    rounds = zip_longest(*groups.values())
    return [task for one in rounds for task in one if task is not None]

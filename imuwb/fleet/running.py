"""Runs calls on an executor: a bounded number at a time, with another attempt after faults that are not those of the log."""

from collections.abc import Iterable, Iterator
from typing import Any

from imuwb.errors import ImuwbError
from imuwb.fleet.executor import Call, Completed, Executor

#: kind of a fault -> attempts in all. A worker may be ended from outside several times in the same log without the log being at fault
ATTEMPTS = {"transport": 2, "lost": 6}
WAITING = 3  #: calls that are submitted for each call that is worked on
LEAST = 8  #: calls that are submitted at least
HOPELESS = 20  #: faults of transport or workers one after another, after which the run ends


def completed(calls: Iterable[Call], executor: Executor) -> Iterator[Completed]:
    """Yield what becomes of each call, with its place among the calls as its number, as soon as it is ready.

    Args:
        calls: that are made when their turn comes: memory does not grow with their number.
        executor: that runs them.

    Raises:
        ImuwbError: no call succeeds any more, because of workers or a store.
    """
    waiting: dict[int, tuple[Call, int]] = {}
    source = enumerate(calls)
    failed = 0
    more = _submit(source, waiting, executor)
    while waiting or more:
        for done in executor.as_completed():
            call, attempt = waiting.pop(done.number)
            kind = "" if done.fault is None else done.fault.kind
            failed = failed + 1 if kind in ATTEMPTS else 0
            if failed >= HOPELESS + 2 * executor.slots and done.fault is not None:
                raise ImuwbError(
                    f"the run ends, because {failed} attempts one after another failed; the last: {done.fault.message}"
                )
            if attempt < ATTEMPTS.get(kind, 1):
                waiting[done.number] = call, attempt + 1
                executor.submit(done.number, call)
            else:
                yield done
            more = _submit(source, waiting, executor)
        more = _submit(source, waiting, executor)


def _submit(source: Iterator[tuple[int, Call]], waiting: dict[int, tuple[Call, int]], executor: Executor) -> bool:
    """Submit calls until enough wait, and return whether there may be more."""
    most = max(WAITING * executor.slots, LEAST)
    while len(waiting) < most:
        following: Any = next(source, None)
        if following is None:
            return False
        number, call = following
        waiting[number] = call, 1
        executor.submit(number, call)
    return True

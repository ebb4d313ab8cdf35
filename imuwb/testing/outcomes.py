"""The outcome of each rule of the contract, and how a rule is asked: an error of the plugin fails the rule, with its place."""

import traceback
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Generic, Literal, TypeVar

State = Literal["passed", "failed", "not applicable"]
Value = TypeVar("Value")

MOST = 3  #: faults of one rule that are named


@dataclass(frozen=True, slots=True)
class Outcome:
    """What one rule found."""

    rule: str
    state: State
    text: str  #: what was found; of a rule that failed, with what to do

    def __str__(self) -> str:
        """Return rule, state and text in a line."""
        return f"{self.rule}: {self.state}: {self.text}"


@dataclass(frozen=True, slots=True)
class Report:
    """The outcomes of all rules for one plugin."""

    name: str
    kind: str  #: "analysis", "conditioner" or "reader"
    outcomes: tuple[Outcome, ...]

    @property
    def failed(self) -> tuple[Outcome, ...]:
        """The rules that the plugin breaks."""
        return tuple(one for one in self.outcomes if one.state == "failed")

    def require(self) -> None:
        """Raise AssertionError if a rule is broken; the message has a line for each such rule.

        Raises:
            AssertionError: a rule is broken.
        """
        if self.failed:
            raise AssertionError(
                "\n".join((f"the {self.kind} {self.name} breaks its contract:", *map(str, self.failed)))
            )


@dataclass(frozen=True, slots=True)
class Attempt(Generic[Value]):
    """What a call of the plugin returned, or the error that it raised."""

    value: Value | None
    error: Exception | None = None

    @property
    def fault(self) -> str:
        """The error as a text with its place; empty: there is none."""
        return "" if self.error is None else error_text(self.error)


def attempt(call: Callable[[], Value]) -> Attempt[Value]:
    """Return what a call returns, or its error."""
    try:
        return Attempt(call())
    except SystemExit as error:  # it would end the check, with the exit code of a plugin that keeps its contract
        ended = RuntimeError(f"SystemExit: {error}, which ends the program; raise an error with the reason")
        return Attempt(None, ended.with_traceback(error.__traceback__))
    except Exception as error:  # noqa: BLE001 - a plugin may raise anything
        return Attempt(None, error)


def error_text(error: Exception) -> str:
    """Return an error with the file and the line that raised it."""
    frames = traceback.extract_tb(error.__traceback__)
    where = f" ({frames[-1].filename}, line {frames[-1].lineno})" if frames else ""
    return f"{type(error).__name__}: {error}{where}"


def outcome(rule: str, faults: Iterable[str], passed: str) -> Outcome:
    """Return the outcome of a rule: failed with its faults, if there are any."""
    found = tuple(dict.fromkeys(faults))
    if not found:
        return Outcome(rule, "passed", passed)
    more = f"; and {len(found) - MOST} more" if len(found) > MOST else ""
    return Outcome(rule, "failed", "; ".join(found[:MOST]) + more)


def skipped(rule: str, reason: str) -> Outcome:
    """Return the outcome of a rule that does not apply."""
    return Outcome(rule, "not applicable", reason)

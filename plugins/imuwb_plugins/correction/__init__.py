"""Correction: takes off what an error model says of bias, scale factors, cross-couplings and g-sensitivity."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path  # noqa: TC003 - the command line reads the annotations as the program runs
from typing import TYPE_CHECKING, Annotated

if TYPE_CHECKING:
    from imuwb.analysis import Review
    from imuwb.log import Log
    from imuwb_plugins.correction.apply import Found


@dataclass(frozen=True)
class Parameters:
    """What can be asked."""

    model: Annotated[Path, "error model, TOML, whose deterministic terms are taken off, at the log's own temperature"]


def condition(log: Log, parameters: Parameters) -> tuple[Log, Found]:
    """Return the corrected log, and what was taken off."""
    from imuwb_plugins.correction import apply  # noqa: PLC0415 - help must not wait for numpy

    return apply.condition(log, parameters.model)


def draw(found: Found, review: Review) -> None:
    """Show what was taken off, axis by axis."""
    from imuwb_plugins.correction import apply  # noqa: PLC0415 - as above

    apply.draw(found, review)

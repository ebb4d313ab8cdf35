"""What a page shows of one run of an analysis: the answer, what was drawn, and where it comes from."""

import shlex
from collections.abc import Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from pathlib import PurePath
from typing import Any, TypeVar, cast

import numpy as np

from imuwb.analysis import Answer, Figure
from imuwb.log import Log
from imuwb.review.answers.panel import Origin, filled
from imuwb.review.drawn.calls import Drawn
from imuwb.review.drawn.still import still
from imuwb.review.drawn.thin import thin, thin_figure
from imuwb.texts import printable

_Any = TypeVar("_Any")


@dataclass(frozen=True, slots=True)
class Source:
    """A log that was analysed."""

    path: str
    format: str
    hash: str
    selection: str = ""  #: the part in time; empty: all

    @property
    def name(self) -> str:
        """Return the file's name."""
        return PurePath(self.path.replace("\\", "/")).name or self.path


@dataclass(frozen=True, eq=False, slots=True)
class Report:
    """One run of an analysis, as a page shows it."""

    analysis: str  #: with its method: "calibration six-position"
    answer: Answer  #: with its commands filled in
    figure: Figure | None  #: shows the answer
    drawn: tuple[Drawn, ...]  #: all else, with no more points than a page shows
    sources: tuple[Source, ...]
    command: str  #: that makes it again
    run: str  #: name of the run, which all its files have
    version: str  #: of imuwb

    @property
    def title(self) -> str:
        """Return analysis and logs: "Noise: static.mcap"."""
        names = list(dict.fromkeys(source.name for source in self.sources))
        if not names:
            return self.analysis.capitalize()
        more = f" and {len(names) - 2} more" if len(names) > 3 else ""  # noqa: PLR2004 - three names fit a line
        return f"{self.analysis.capitalize()}: {', '.join(names[:2] if more else names)}{more}"


def report_of(
    answer: Answer, origin: Origin, drawn: Sequence[Drawn], logs: Sequence[Log], run: str, version: str
) -> Report:
    """Return the report of a run.

    Args:
        answer: of the analysis.
        origin: the analysis, the logs as they were given, and the command.
        drawn: all that the analysis has drawn.
        logs: that were analysed.
        run: name of the run.
        version: of imuwb.
    """
    figure = answer.figure or next((one.item for one in drawn if isinstance(one.item, Figure)), None)
    answer = replace(answer, next=filled(answer.next, origin), figure=None, numbers={})
    sources = tuple(Source(p.path, p.format, p.hash, p.selection) for p in (log.provenance for log in logs))
    shown = tuple(thin(one) for one in still(drawn) if figure is None or not _is_same(one.item, figure))
    command = origin.command or shlex.join(("imuwb", *origin.analysis.split(), *origin.logs))
    first = None if figure is None else thin_figure(figure)
    return cleaned(Report(origin.analysis, answer, first, shown, sources, command, run, version))


def _is_same(item: object, figure: Figure) -> bool:
    """Return whether what was drawn is a figure, or one made again with the same curves."""
    if item is figure or not isinstance(item, Figure):
        return item is figure
    return (item.title, len(item.curves)) == (figure.title, len(figure.curves)) and all(
        np.array_equal(a.y, b.y, equal_nan=True) for a, b in zip(item.curves, figure.curves, strict=True)
    )


def cleaned(value: _Any) -> _Any:
    """Return a frozen value whose texts a page can show: characters that it cannot show are replaced."""
    whole: Any = value
    if isinstance(value, str):
        whole = printable(value)
    elif isinstance(value, tuple):
        whole = tuple(cleaned(item) for item in cast("tuple[object, ...]", value))
    elif is_dataclass(value) and not isinstance(value, type):
        whole = replace(value, **{field.name: cleaned(getattr(value, field.name)) for field in fields(value)})
    return whole

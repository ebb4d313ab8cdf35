"""Parts that all studies share: tables of estimates in Markdown, the command line, workers, the papers' published figures.

The seed of a record is its number; ``numpy.random.SeedSequence`` makes independent streams from that number.
A table contains no date and no name of a machine: a study that runs again writes the same file.
"""

from __future__ import annotations

import argparse
import math
import sys
import tomllib
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from scipy import stats

import imuwb

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

sys.path.append(str(Path(__file__).resolve().parents[2]))  # a script's own folder is on the path, the repository is not
from tests.recordings import FOLDER

GOALS = ("figure", "goal", "result", "verdict")  #: headings of a table of goals


@dataclass(frozen=True)
class Share:
    """A count out of a total, with the 95 % interval of Clopper and Pearson."""

    count: int
    of: int

    @property
    def value(self) -> float:
        return self.count / self.of if self.of else math.nan

    @property
    def interval(self) -> tuple[float, float]:
        low, high = stats.beta.ppf(
            (0.025, 0.975), (self.count, self.count + 1), (self.of - self.count + 1, self.of - self.count)
        )
        return (0.0 if not self.count else float(low), 1.0 if self.count == self.of else float(high))

    def text(self, digits: int = 1) -> str:
        """Return the share and its interval in per cent, with this many digits after the point."""
        if not self.of:
            return "–"
        low, high = self.interval
        return f"{100 * self.value:.{digits}f} % ({100 * low:.{digits}f}–{100 * high:.{digits}f})"

    __str__ = text


@dataclass(frozen=True)
class Mean:
    """A mean and its standard error."""

    value: float
    error: float

    @property
    def off(self) -> float:
        """Return how many standard errors the mean is from 1; 0 where the difference is rounding only."""
        return 0.0 if abs(self.value - 1) < 1e-9 else (self.value - 1) / max(self.error, 1e-12)

    def __str__(self) -> str:
        return f"{self.value:.4f} ± {self.error:.4f}"


@dataclass(frozen=True)
class Table:
    """A table with a title; ``note`` explains how to read it."""

    title: str
    headings: tuple[str, ...]
    rows: tuple[tuple[object, ...], ...]
    note: str = ""

    def column(self, heading: str) -> tuple[object, ...]:
        place = self.headings.index(heading)
        return tuple(row[place] for row in self.rows)

    def markdown(self) -> str:
        lines = ["| " + " | ".join(cells) + " |" for cells in (self.headings, ("---",) * len(self.headings))]
        lines += ["| " + " | ".join(map(_cell, row)) + " |" for row in self.rows]
        return "\n".join((f"## {self.title}", "", *((self.note, "") if self.note else ()), *lines, ""))


def _cell(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def pooled(shares: Iterable[Share]) -> Share:
    """Return the share of several counts together."""
    counts = [(share.count, share.of) for share in shares]
    return Share(sum(count for count, _ in counts), sum(of for _, of in counts))


def verdict(reached: bool) -> str:  # noqa: FBT001 - the only argument
    """Return the verdict on a goal."""
    return "reached" if reached else "NOT reached"


@cache
def published(paper: str) -> dict[str, object]:
    """Return the published figures of a paper; an empty dict where the file of figures is absent."""
    path = FOLDER / "papers" / "tables.toml"
    return tomllib.loads(path.read_text("utf-8"))[paper] if path.exists() else {}


def over_records(work: Callable[..., object], jobs: Iterable[tuple[object, ...]], workers: int) -> list[object]:
    """Return ``work(*job)`` of every job, in order; one worker is this process itself."""
    if workers == 1:
        return [work(*job) for job in jobs]
    with ProcessPoolExecutor(workers) as pool:
        return list(pool.map(work, *zip(*jobs, strict=True)))


def main(
    script: str, question: str, study: Callable[[int], tuple[Table, ...]], records: int, about: Callable[[int], str]
) -> None:
    """Run a study from the command line and write its tables into a file beside the script."""
    parser = argparse.ArgumentParser(description=question)
    parser.add_argument(
        "--records", type=int, default=records, metavar="N", help=f"Number of records (default: {records})."
    )
    parser.add_argument(
        "--output", type=Path, default=Path(script).with_suffix(".md"), metavar="FILE",
        help="File for the tables (default: beside the script).",
    )  # fmt: skip
    options = parser.parse_args()
    tables = study(options.records)
    name = Path(script).stem
    option = "" if options.records == records else f" --records {options.records}"
    command = f"    python tests/studies/{name}.py{option}"
    head = f"{command}\n\nimuwb {imuwb.__version__}; {about(options.records)}\n\n# {question}\n"
    text = "\n".join((head, *(table.markdown() for table in tables)))
    options.output.write_text(text, "utf-8")
    print(text)

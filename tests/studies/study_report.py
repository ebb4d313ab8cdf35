"""What the studies share: tables of estimates, their Markdown, the command line, the seeds.

The seed of a record is its number; ``numpy.random.SeedSequence`` makes independent streams of it.
Nothing here knows the day or the machine, so a study that is run again gives the same file.
"""

from __future__ import annotations

import argparse
import math
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from scipy import stats

import imuwb

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable


@dataclass(frozen=True)
class Share:
    """So many of so many. Its interval is Clopper and Pearson's, 95 %."""

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

    def __str__(self) -> str:
        if not self.of:
            return "–"
        low, high = self.interval
        return f"{100 * self.value:.1f} % ({100 * low:.1f}–{100 * high:.1f})"


@dataclass(frozen=True)
class Mean:
    """A mean and its standard error."""

    value: float
    error: float

    @property
    def off(self) -> float:
        """Return how many standard errors the mean is from 1; 0 where both differ by rounding only."""
        return 0.0 if abs(self.value - 1) < 1e-9 else (self.value - 1) / max(self.error, 1e-12)

    def __str__(self) -> str:
        return f"{self.value:.4f} ± {self.error:.4f}"


@dataclass(frozen=True)
class Table:
    """A titled table; ``note`` says how to read it."""

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


def verdict(reached: bool) -> str:  # noqa: FBT001 - one thing, said or not
    """Return what a summary says of a figure."""
    return "reached" if reached else "NOT reached"


def over_records(work: Callable[..., object], jobs: Iterable[tuple[object, ...]], workers: int) -> list[object]:
    """Return ``work(*job)`` of every job, in order; in this process when there is one worker."""
    if workers == 1:
        return [work(*job) for job in jobs]
    with ProcessPoolExecutor(workers) as pool:
        return list(pool.map(work, *zip(*jobs, strict=True)))


def main(
    script: str, question: str, study: Callable[[int], tuple[Table, ...]], records: int, about: Callable[[int], str]
) -> None:
    """Run a study from the command line and write its tables next to it."""
    parser = argparse.ArgumentParser(description=question)
    parser.add_argument("--records", type=int, default=records, metavar="N", help=f"default: {records}")
    parser.add_argument("--output", type=Path, default=Path(script).with_suffix(".md"), metavar="FILE")
    given = parser.parse_args()
    tables = study(given.records)
    name = Path(script).stem
    option = "" if given.records == records else f" --records {given.records}"
    command = f"    python tests/studies/{name}.py{option}"
    head = f"{command}\n\nimuwb {imuwb.__version__}; {about(given.records)}\n\n# {question}\n"
    text = "\n".join((head, *(table.markdown() for table in tables)))
    given.output.write_text(text, "utf-8")
    print(text)

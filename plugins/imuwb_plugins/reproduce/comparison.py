"""A paper's values beside ours, and whether they agree."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from imuwb.analysis import Bars, Figure
from imuwb.statistics import Estimate
from imuwb_plugins.reproduce.printed import Key, Paper, Printed, PrintedValue

#: The rule of agreement, as the recording states it.
RULE = (
    "Two values agree if they differ by at most √(a² + b²): a and b are the half widths of their 95 % intervals. A printed value "
    "without an interval counts with half a unit of its last digit. Chance alone makes about one value in twenty differ."
)
AGREES, DIFFERS, OTHER = "agrees", "differs", "other data"


@dataclass(frozen=True, eq=False, slots=True)
class Found:
    """What one run of all analyses has found."""

    values: Mapping[Key, Estimate | str]  #: in the unit that the paper prints; a text: the reason why there is none
    figures: Mapping[str, tuple[Figure | Bars, ...]] = field(default_factory=dict[str, tuple[Figure | Bars, ...]])
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Row:
    """One value of a paper, and ours."""

    quantity: str
    item: str
    unit: str
    published: str  #: as printed
    published_value: float
    published_half_width: float
    ours: Estimate | None
    verdict: str  #: "agrees", "differs", "other data", or why there is no value

    @property
    def ratio(self) -> float:
        """Our value over the paper's; nan where there is none."""
        return self.ours.value / self.published_value if self.ours and self.published_value else math.nan


@dataclass(frozen=True, slots=True)
class TableComparison:
    """One table of a paper beside ours."""

    number: str
    title: str
    command: str
    readings: tuple[str, ...]
    reason: str  #: why it is not made again
    rows: tuple[Row, ...]

    @property
    def name(self) -> str:
        """Its name: "table 4", or that of a section."""
        return f"table {self.number}" if self.number[0].isdigit() else self.number

    def count(self, verdict: str) -> int:
        """Return how many rows have a verdict."""
        return sum(row.verdict == verdict for row in self.rows)


@dataclass(frozen=True, eq=False, slots=True)
class FigureComparison:
    """One figure of a paper, drawn from our data."""

    number: str
    title: str
    command: str
    readings: tuple[str, ...]
    reason: str  #: why it is not drawn
    drawings: tuple[Figure | Bars, ...]


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class Reproduction:
    """A paper beside what imuwb finds."""

    paper: str
    title: str
    source: str
    data: str  #: what ours is of
    seeds: int
    simulated: bool  #: whether more seeds would make more of it
    command: str  #: "reproduce quinchia"
    rule: str
    tables: tuple[TableComparison, ...]
    figures: tuple[FigureComparison, ...]
    equations: tuple[Printed, ...]
    notes: tuple[str, ...]

    def count(self, verdict: str) -> int:
        """Return how many rows of all tables have a verdict."""
        return sum(table.count(verdict) for table in self.tables)

    def __repr__(self) -> str:
        """Return the agreement of each table, a line each."""
        lines = (
            f"  table {t.number}: {t.count(AGREES)} agree, {t.count(DIFFERS)} differ" for t in self.tables if t.rows
        )
        return "\n".join([f"{self.paper}, {self.data}", *lines])


def compared(paper: Paper, runs: Sequence[Found], data: str, *, simulated: bool) -> Reproduction:
    """Return a paper beside the runs, one for each seed.

    Raises:
        KeyError: a run has neither a value nor a reason for a printed value, or neither a drawing nor a reason for a figure.
    """
    tables = tuple(
        TableComparison(
            t.number, t.title, t.command, t.readings, t.reason, tuple(_row(value, runs) for value in t.values)
        )
        for t in paper.tables
    )
    figures = tuple(
        FigureComparison(
            f.number, f.title, f.command, f.readings, f.reason, () if f.reason else runs[0].figures[f.number]
        )
        for f in paper.figures
    )
    notes = tuple(dict.fromkeys(note for run in runs for note in run.notes))
    return Reproduction(
        paper.name, paper.title, paper.source, data, len(runs), simulated and len(runs) == 1, f"reproduce {paper.name}", RULE, tables, figures, paper.equations, notes
    )  # fmt: skip


def of_other_data(reproduction: Reproduction, tables: frozenset[str]) -> Reproduction:
    """Return the same where some tables are of a sensor or a drive of the user's own, which need not agree."""

    def changed(row: Row) -> Row:
        return replace(row, verdict=OTHER) if row.ours is not None else row

    return replace(
        reproduction,
        tables=tuple(
            replace(t, rows=tuple(map(changed, t.rows))) if t.number in tables else t for t in reproduction.tables
        ),
    )


def _row(value: PrintedValue, runs: Sequence[Found]) -> Row:
    found = [run.values[value.key] for run in runs]
    estimates = [one for one in found if isinstance(one, Estimate)]
    ours = over_seeds(estimates)
    reasons = [one for one in found if isinstance(one, str)]
    verdict = verdict_of(value, ours) if ours is not None else reasons[0]
    return Row(
        value.key.quantity, value.key.item, value.unit, str(value), value.value, value.half_width, ours, verdict
    )  # fmt: skip


def over_seeds(estimates: Sequence[Estimate]) -> Estimate | None:
    """Return the estimate of one seed as it is; of several, their mean and the 95 % interval in which that of one more seed lies."""
    if len(estimates) < 2:  # noqa: PLR2004 - a spread needs two
        return estimates[0] if estimates else None
    from scipy.stats import t  # noqa: PLC0415 - one seed needs no quantile

    n, values = len(estimates), [one.value for one in estimates]
    mean = sum(values) / n
    sigma = math.sqrt(sum((v - mean) ** 2 for v in values) / (n - 1))
    half = float(t.ppf(0.975, n - 1)) * sigma * math.sqrt(1 + 1 / n)
    return Estimate(mean, mean - half, mean + half, sigma, estimates[0].unit)


def verdict_of(value: PrintedValue, ours: Estimate) -> str:
    """Return whether a printed value and ours agree, by ``RULE``; "other data" where no simulation can give the value again."""
    if value.other:
        return OTHER
    half = ours.upper - ours.value if value.value > ours.value else ours.value - ours.lower
    limit = math.hypot(0.0 if math.isnan(half) else half, value.half_width)
    return AGREES if abs(ours.value - value.value) <= limit else DIFFERS

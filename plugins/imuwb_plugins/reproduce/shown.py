"""A paper beside ours, shown."""

import math
from collections.abc import Iterator, Sequence
from itertools import cycle
from typing import TypeVar

import numpy as np

from imuwb.analysis import Answer, Bars, Curve, Figure, Review, Step, Table
from imuwb.colors import BLUE, BROWN, GREEN, ORANGE, PALE, PINK, PURPLE, RED, TEAL, YELLOW
from imuwb.statistics import Estimate
from imuwb_plugins.reproduce.comparison import (
    AGREES,
    DIFFERS,
    OTHER,
    FigureComparison,
    Reproduction,
    Row,
    TableComparison,
)

MOST_ROWS = 7  #: of the answer
COLORS = (RED, BLUE, GREEN, ORANGE, PURPLE, TEAL, YELLOW, BROWN, PINK)
ROWS, DRAWINGS = 45, 4  #: on a tab
Item = TypeVar("Item", TableComparison, FigureComparison)
HEADINGS = ("value", "of", "unit", "the paper", "ours [95 % interval]", "ours / the paper's", "verdict")


def draw(result: Reproduction, review: Review) -> None:
    """Show the rule, every table and figure with what makes it, and the equations."""
    review.note(f"{result.title}. {result.source}.")
    review.note(f"Ours: {result.data}.")
    review.note(result.rule)
    for note in result.notes:
        review.note(note)
    review.table(_contents(result))
    for tables in _grouped([t for t in result.tables if t.rows], [len(t.rows) for t in result.tables if t.rows], ROWS):
        review.tab(_named("Table", tables))
        for table in tables:
            _table(table, review)
    drawn = [f for f in result.figures if f.drawings]
    for figures in _grouped(drawn, [len(f.drawings) for f in drawn], DRAWINGS):
        review.tab(_named("Figure", figures))
        for figure in figures:
            _figure(figure, review)
    review.tab("Equations")
    rows = tuple((e.number, ". ".join((e.title, *e.readings)), e.command) for e in result.equations)
    review.table(Table("Equations", ("number", "what", "where imuwb has it"), rows, wide=True))


def _grouped(items: Sequence[Item], sizes: Sequence[int], most: int) -> Iterator[list[Item]]:
    """Yield items in their order, as many on a tab as it has room for."""
    group, taken = list[Item](), 0
    for item, size in zip(items, sizes, strict=True):
        if group and taken + size > most:
            yield group
            group, taken = [], 0
        group.append(item)
        taken += size
    if group:
        yield group


def _named(kind: str, items: Sequence[TableComparison] | Sequence[FigureComparison]) -> str:
    """Return the name of a tab: "Table 2", "Tables 3-5", or "Section 7"."""
    numbers = [item.number for item in items]
    if not numbers[0][0].isdigit():
        return numbers[0].capitalize()
    numbered = [n for n in numbers if n[0].isdigit()]
    return f"{kind} {numbers[0]}" if len(numbered) == 1 else f"{kind}s {numbered[0]}-{numbered[-1]}"


def _contents(result: Reproduction) -> Table:
    tables = tuple((t.name, t.title, _state(t)) for t in result.tables)
    figures = tuple(
        (f"figure {f.number}", f.title, f.reason or (f.command if f.drawings else "these data have none"))
        for f in result.figures
    )
    return Table(
        "Tables and figures of the paper", ("", "what", "agreement, or what makes it"), tables + figures, wide=True
    )


def _state(table: TableComparison) -> str:
    """Return how many values agree: "24 agree, 3 differ, 2 without a value"."""
    if not table.rows:
        return table.reason
    counted = [(table.count(AGREES), "agree"), (table.count(DIFFERS), "differ"), (table.count(OTHER), "of other data")]
    rest = len(table.rows) - sum(count for count, _ in counted)
    return ", ".join(f"{count} {word}" for count, word in (*counted, (rest, "without a value")) if count)


def _table(table: TableComparison, review: Review) -> None:
    rows = tuple(cells_of(row) for row in table.rows)
    caption = f"Made with: {table.command}" if table.command else ""
    review.table(Table(f"{table.name.capitalize()}: {table.title}", HEADINGS, rows, caption, wide=True))
    for reading in table.readings:
        review.note(reading)


def cells_of(row: Row) -> tuple[str, ...]:
    """Return a row of ``HEADINGS``."""
    unit = "" if row.unit == "1" else row.unit
    ratio = "—" if math.isnan(row.ratio) else f"{row.ratio:.3f}"
    return (row.quantity, row.item.replace("_", " "), unit, row.published, _text(row), ratio, row.verdict)


def _text(row: Row) -> str:
    """Return our value with its interval, with the digits that the interval leaves."""
    ours = row.ours
    if ours is None:
        return "—"
    digits = _digits(ours, row.published_half_width)
    if not math.isfinite(ours.upper - ours.lower) or ours.upper == ours.lower:
        return f"{ours.value:.{digits}g}"
    return f"{ours.value:.{digits}g} [{ours.lower:.{digits}g}, {ours.upper:.{digits}g}]"


def _digits(ours: Estimate, finest: float) -> int:
    """Return the number of significant digits that show a tenth of the interval, or of the last printed digit; 3 to 8."""
    width = ours.upper - ours.lower
    small = width if 0 < width < math.inf else 2 * finest
    if not ours.value or not small:
        return 3
    return min(max(math.ceil(math.log10(abs(ours.value) / small)) + 2, 3), 8)


def _figure(figure: FigureComparison, review: Review) -> None:
    review.note(f"Figure {figure.number}: {figure.title}. Made with: {figure.command}")
    for reading in figure.readings:
        review.note(reading)
    for drawing in figure.drawings:
        if isinstance(drawing, Bars):
            review.bars(drawing)
        else:
            review.figure(drawing)


def answer(result: Reproduction) -> Answer:
    """Return the agreement of each table, the least agreement first; what differs most; and how to open a table."""
    judged = [t for t in result.tables if t.rows]
    judged.sort(key=lambda t: (-t.count(DIFFERS), -t.count(AGREES)))
    rows = tuple(
        (
            t.name, str(len(t.rows)), str(t.count(AGREES)), str(t.count(DIFFERS)),
            str(t.count(OTHER)), _worst(t),
        )
        for t in judged[:MOST_ROWS]
    )  # fmt: skip
    total, agree, differ = sum(len(t.rows) for t in judged), result.count(AGREES), result.count(DIFFERS)
    drawn = sum(bool(f.drawings) for f in result.figures)
    sentences = [
        f"{agree} of {agree + differ} values that a simulation can give again agree; {total - agree - differ} are of the paper's own data."
    ]
    sentences.append(
        f"{drawn} of {len(result.figures)} figures are drawn; the others are photographs and drawings of methods."
    )
    again = (Step(f"imuwb {result.command} --seeds 10", "intervals from ten simulations"),) if result.simulated else ()
    return Answer(
        result.data, ("", "values", "agree", "differ", "other data", "differs most"), rows, tuple(sentences), again,
        figure=_ratios([t for t in result.tables if t.rows]),
    )  # fmt: skip


def _ratios(tables: Sequence[TableComparison]) -> Figure:
    """Return the figure of the answer: our value over the paper's, of every value of every table."""
    curves, begin = list[Curve](), 1
    for table, color in zip(tables, cycle(COLORS), strict=False):
        known = [(i, r) for i, r in enumerate(table.rows, begin) if r.ours and r.ratio > 0 and r.verdict != OTHER]
        begin += len(table.rows)
        if not known:
            continue
        x = np.array([float(i) for i, _ in known])
        y, low, high = (
            np.array([getattr(row.ours, end) / row.published_value for _, row in known])
            for end in ("value", "lower", "upper")
        )
        low, high = np.minimum(low, high), np.maximum(low, high)
        shown = np.isfinite(low) & np.isfinite(high) & (low > 0)
        curves.append(Curve(table.name, x, y, color, np.where(shown, low, y), np.where(shown, high, y), style="points"))
    line = np.array([1.0, float(max(begin - 1, 2))])
    curves.append(Curve("as printed", line, np.ones(2), PALE, style="fit"))
    return Figure(
        "Ours over the paper's, every value that a simulation can give again", "number of the value, table by table [1]", "ratio [1]", tuple(curves), x_scale="linear"
    )  # fmt: skip


def _worst(table: TableComparison) -> str:
    """Return the value that differs most, by its ratio."""
    differing = [r for r in table.rows if r.verdict == DIFFERS and r.ours is not None and r.ratio > 0]
    if not differing:
        return ""
    worst = max(differing, key=lambda r: abs(math.log(r.ratio)))
    return f"{worst.ratio:.2f} times: {worst.quantity}, {worst.item.replace('_', ' ')}"  # the ratio is never cut

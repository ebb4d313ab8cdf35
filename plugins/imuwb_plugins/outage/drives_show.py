"""The recording of several drives: all of them pooled, then each alone."""

from dataclasses import replace

from imuwb.analysis import Review, Table
from imuwb.colors import INK
from imuwb.names import distinct
from imuwb.texts import interval_text, number_text
from imuwb_plugins.outage import figures, paper, show, tables
from imuwb_plugins.outage.drives import Drives
from imuwb_plugins.outage.result import DurationSummary, Result

NAME = 32  #: columns of the name of a drive


def draw(result: Result | Drives, review: Review) -> None:
    """Show the drift of each filter, whether its sigma is right, and the details."""
    if isinstance(result, Result):
        show.draw(result, review)
        return
    first = next(iter(result.drives.values()))
    for own in result.pooled:
        table = tables.drift(own, first)
        review.table(replace(table, title=f"{table.title}, all drives"))
    for own in result.pooled:
        review.table(_by_drive(own, result))
        review.figure(figures.drift(own))
    for note in (*result.verdicts, *result.notes):
        review.note(note)
    outages = [own for one in result.drives.values() for own in sorted(one.outages, key=paper.begin)]
    if len(outages) <= show.FEW:
        review.tab("Outages")
        paper.draw(outages, result.published, review)
    _consistency(result, review)
    for name, one in zip(distinct(tuple(result.drives), NAME), result.drives.values(), strict=True):
        _draw_drive(name, one, review)


def _consistency(result: Drives, review: Review) -> None:
    review.tab("Consistency")
    for own in result.pooled:
        review.figure(figures.consistency(own))
        table = tables.consistency(own)
        review.table(replace(table, title=f"{table.title}, all drives"))
        if own.choice is not None:
            review.table(tables.choice(own.choice))
        if own.paired:
            review.table(tables.paired(own))


def _by_drive(own: DurationSummary, result: Drives) -> Table:
    """Return the median drift and the consistency of each filter in each drive."""
    rows: list[tuple[str, ...]] = []
    for name, one in zip(distinct(tuple(result.drives), NAME), result.drives.values(), strict=True):
        for summary in (s for s in one.summary if s.duration == own.duration):
            rows += [
                (
                    name, model, f"{s.count} ({s.effective_count})", interval_text(s.estimate("median_end")),
                    "—" if s.nees_per_dof is None else number_text(s.nees_per_dof),
                    "—" if s.coverage95 is None else f"{s.coverage95 * 100:.0f} %", one.reference,
                )
                for model, s in summary.models.items()
            ]  # fmt: skip
    headings = (
        "drive", "filter", "outages (without overlap)", "median at the end", "NEES/2 at the end",
        "outages within the 95 % ellipse", "reference",
    )  # fmt: skip
    return Table(f"Each drive, outages of {own.duration:g} s", headings, tuple(rows))


def _draw_drive(name: str, one: Result, review: Review) -> None:
    paper.pictures(one.pictures, review, name)
    review.tab(name)
    for own in one.summary:
        review.figure(figures.drift(own))
    review.track(f"{name}_reference", one.reference_track, INK)
    review.table(tables.outages(one))
    for note in (*one.verdicts, *one.notes):
        review.note(f"{name}: {note}")

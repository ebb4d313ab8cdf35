"""What the paper shows of its outages: tables 9 and 10, figures 21 to 25 by outage, and figure 26 (Quinchia)."""

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from imuwb.analysis import Curve, Figure, Review, Table
from imuwb.colors import INK
from imuwb_plugins.outage.figures import ERROR, TIME, colors_of
from imuwb_plugins.outage.result import OutagePicture, OutageResult, PublishedGain
from imuwb_plugins.outage.summary import TESTED
from imuwb_plugins.outage.tables import outage_cells

WIDTH = 0.8  #: of the bars of one outage, where two outages are 1 apart
AGAINST = "against each filter's own run without outages"


def begin(own: OutageResult) -> tuple[float, float]:
    """Return the order of an outage in its drive: by start, then by duration."""
    return own.start, own.duration


def names_of(outages: Iterable[OutageResult]) -> list[str]:
    """Return the filters that have an error against their own run, in their order; an engine has none."""
    names = dict.fromkeys(name for own in outages for name in own.models)
    return [name for name in names if all(np.isfinite(o.models[name].own_max) for o in outages if name in o.models)]


def draw(outages: Sequence[OutageResult], gains: dict[str, PublishedGain], review: Review) -> None:
    """Show the tables, and the figure of all outages."""
    for table in tables(outages, gains):
        review.table(table)
    for figure in each_outage(outages):
        review.figure(figure)


def tables(outages: Sequence[OutageResult], gains: dict[str, PublishedGain]) -> Iterator[Table]:
    """Yield the errors of each filter against its own run, a table for each of the user's texts (Quinchia, tables 9 and 10)."""
    names = names_of(outages)
    groups = list(dict.fromkeys(own.table for own in outages))
    improved = f"Improvement: mean over the outages of 1 - {TESTED}/filter, as in the paper."
    for group in groups:
        rows: list[tuple[str, ...]] = [
            (*outage_cells(o, 2), *(_pair(o, name) for name in names)) for o in outages if o.table == group
        ]  # fmt: skip
        caption = ""
        if gains and len(groups) == 1:
            rows.append(_gain_row(gains, names))
            caption = improved
        title = f"Table {group}: mean" if group else "Mean"
        paper = "" if group else " (Quinchia, tables 9 and 10)"
        headings = ("start", "duration", "mean speed", *names)
        yield Table(f"{title} / largest error {AGAINST}{paper}", headings, tuple(rows), caption)
    if gains and len(groups) > 1:
        row = _gain_row(gains, names)
        yield Table(f"Improvement by {TESTED} over all tables", ("", *names), ((row[0], *row[3:]),), improved)


def _pair(own: OutageResult, name: str) -> str:
    errors = own.models.get(name)
    return "—" if errors is None else f"{errors.own_mean:.2f} / {errors.own_max:.2f} m"


def _gain_row(gains: dict[str, PublishedGain], names: Sequence[str]) -> tuple[str, ...]:
    cells = (f"{g.own_mean * 100:.1f} / {g.own_max * 100:.1f} %" if (g := gains.get(name)) else "—" for name in names)
    return (f"improvement by {TESTED}", "", "", *cells)


def each_outage(outages: Sequence[OutageResult]) -> Iterator[Figure]:
    """Yield the largest and the mean error of each filter in each outage, against its own run (Quinchia, figure 26)."""
    names = names_of(outages)
    number = np.arange(1.0, len(outages) + 1)
    for part, what, panel in (("own_max", "Largest", "a"), ("own_mean", "Mean", "b")):
        curves: list[Curve] = []
        for k, (name, color) in enumerate(colors_of(names).items()):
            place = number + WIDTH * ((k + 0.5) / len(names) - 0.5)
            errors = np.array([getattr(o.models[name], part) if name in o.models else np.nan for o in outages])
            curves.append(Curve(name, place, errors, color, style="bar"))
        highest = max((float(np.nanmax(curve.y)) for curve in curves), default=1.0)
        yield Figure(
            f"{what} horizontal error in each outage {AGAINST} (Quinchia, figure 26{panel})",
            "number of the outage in the tables [1]", ERROR, tuple(curves), x_scale="linear", y_scale="linear",
            x_limits=(0.5, len(outages) + 0.5), y_limits=(0.0, 1.08 * highest),
        )  # fmt: skip


def pictures(given: Sequence[OutagePicture], review: Review, drive: str = "") -> None:
    """Show each given outage on a tab: the plane, and the errors of the filters against their own runs (Quinchia, figures 21 to 25)."""
    for own in given:
        review.tab(f"{drive} outage {own.name}".strip())
        colors = colors_of(own.tracks)
        review.track(f"the reference in outage {own.name}", own.reference, INK, "reference")
        for name, position in own.tracks.items():
            review.track(name, position, colors[name])  # the legend of the figure beside it names the colours
        curves = tuple(Curve(name, own.elapsed, e, colors[name], style="curve") for name, e in own.errors.items())
        review.figure(
            Figure(
                f"Outage {own.name}: horizontal error {AGAINST}",
                TIME,
                ERROR,
                curves,
                x_scale="linear",
                y_scale="linear",
            )
        )

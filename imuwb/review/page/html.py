"""Writes the page of an analysis: the panel, figures, tables and notes by tab, and where they come from."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib import resources

from jinja2 import Environment, StrictUndefined

from imuwb.analysis import Figure, Series, Table
from imuwb.log import Log
from imuwb.review.drawn import Drawn, Track
from imuwb.review.page.svg import Picture, figure_picture, series_picture, track_picture

OVERVIEW = "Overview"  #: begin of the names of the tabs that show the logs
MOST_SERIES = 6  #: of a tab
MOST_TRACKS = 12


@dataclass(frozen=True, slots=True)
class Part:
    """What one tab of the recording shows."""

    title: str
    name: str  #: for links
    pictures: tuple[Picture, ...]
    tables: tuple[Table, ...]
    notes: tuple[str, ...]


def page(
    title: str, panel: Sequence[str], drawn: Sequence[Drawn], logs: Sequence[Log], command: str, version: str,
    run: str, figure: Figure | None = None,
) -> str:  # fmt: skip
    """Return the HTML of an analysis: one file without links to others.

    Args:
        title: of the page.
        panel: the lines of the answer.
        drawn: all that the analysis has drawn.
        logs: the logs that were analysed.
        command: that makes the page again.
        version: of imuwb.
        run: name of the run, which all its files have.
        figure: shown beside the answer; None: the first one that was drawn.
    """
    first = figure or next((one.item for one in drawn if isinstance(one.item, Figure)), None)
    counter = iter(range(1_000_000))
    shown = None if first is None else figure_picture(first, next(counter))
    parts = tuple(_parts([one for one in drawn if one.item is not first], counter))
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    template = environment.from_string(
        resources.files("imuwb.review.page").joinpath("page.html.jinja").read_text("utf-8")
    )
    sources = [(log.provenance.path, log.provenance.format, log.provenance.hash) for log in logs]
    return template.render(
        title=title,
        panel=panel,
        figure=shown,
        parts=parts,
        sources=sources,
        command=command,
        version=version,
        run=run,
    )


def _parts(drawn: Sequence[Drawn], counter: Iterator[int]) -> Iterator[Part]:
    tabs = list(dict.fromkeys(one.tab for one in drawn))
    for number, tab in enumerate(
        sorted(tabs, key=lambda tab: tab.startswith(OVERVIEW))
    ):  # the answer's own parts first
        items = [one.item for one in drawn if one.tab == tab]
        pictures = [figure_picture(item, next(counter)) for item in items if isinstance(item, Figure)]
        series = [item for item in items if isinstance(item, Series) and item.time.size]
        pictures += [series_picture(item, next(counter)) for item in series[:MOST_SERIES]]
        tracks = [item for item in items if isinstance(item, Track) and len(item.position)]
        if tracks:
            pictures.append(track_picture(tracks[:MOST_TRACKS], next(counter)))
        tables = tuple(item for item in items if isinstance(item, Table))
        notes = tuple(str(item) for item in items if isinstance(item, str))
        if len(series) > MOST_SERIES:
            notes += (f"{len(series) - MOST_SERIES} more series are in the recording",)
        if len(tracks) > MOST_TRACKS:
            notes += (f"{len(tracks) - MOST_TRACKS} more tracks are in the recording",)
        if pictures or tables or notes:
            yield Part(tab, f"part-{number}", tuple(pictures), tables, notes)

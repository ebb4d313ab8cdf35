"""Writes pages: the answer, a figure that shows it, notes, then all figures and tables, and where they come from."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from importlib import resources
from typing import Any

from jinja2 import Environment, FunctionLoader, StrictUndefined

from imuwb.analysis import Figure, Series, Table
from imuwb.review.page.canvas import Drawing, Look
from imuwb.review.page.pictures import Picture, drawings, picture
from imuwb.review.page.report import Report
from imuwb.review.page.small import with_classes
from imuwb.review.page.themes import DARK, GRID_NAME, INK_NAME, LIGHT, PAGE, PRINT, color_of, readable, text_of
from imuwb.texts import printable_lines
from imuwb.units import UNITS

OVERVIEW = ("Overview", "Streams", "Logs")  #: begin of the names of the tabs that show the logs
MOST_SERIES = 6  #: of a tab
MOST_TRACKS = 12
NOTES = 6  #: that are shown at once
#: letters of a line of a table on paper; of a cell and of a heading that are then broken
PAPER_LETTERS, LONG_CELL, WORD = 125, 24, 12
_COLOR = re.compile(r"#[0-9a-f]{6}")


@dataclass(frozen=True, slots=True)
class Part:
    """What one tab of the recording shows."""

    title: str
    name: str  #: for links
    pictures: tuple[Picture, ...]
    tables: tuple[Table, ...]
    more: str  #: what is left out; empty: nothing

    @property
    def contents(self) -> str:
        """Return how much there is: "2 figures, 5 tables"."""
        counts = ((len(self.pictures), "figure"), (len(self.tables), "table"))
        return ", ".join(f"{count} {word}{'s' if count > 1 else ''}" for count, word in counts if count)


@dataclass(frozen=True, slots=True)
class Section:
    """One run of an analysis."""

    title: str
    name: str
    report: Report
    figure: Picture | None  #: shows the answer
    parts: tuple[Part, ...]
    notes: tuple[str, ...]


def page(reports: Sequence[Report], title: str = "", remarks: Sequence[str] = ()) -> str:
    """Return the HTML of one or several runs: one file without links to others, for a light and a dark screen, and for paper.

    Args:
        reports: the runs, in order.
        title: of the page; empty: that of the run.
        remarks: what a reader must know of the runs together.
    """
    return _whole(reports, title, remarks, PAGE, printed=False)


def printed(reports: Sequence[Report], title: str = "", remarks: Sequence[str] = ()) -> str:
    """Return the HTML of a page for paper: all parts open, its colours stated where they are used."""
    return _whole(reports, title, remarks, PRINT, printed=True)


def fragment(report: Report) -> str:
    """Return the answer and its figure as HTML for a notebook: it brings its styles, and takes the colours of what is round it."""
    shown = None if report.figure is None else picture(report.figure, PAGE, f"i{id(report):x}-")
    svg = "" if shown is None else shown.svg.replace(INK_NAME, "currentColor").replace(GRID_NAME, "#88888855")
    return _environment().get_template("fragment.html.jinja").render(report=report, svg=svg)


def svg_of(drawing: Drawing, prefix: str = "s-") -> str:
    """Return a figure, a series or tracks as an SVG element for a light background, complete in itself."""
    return picture(drawing, PRINT, prefix).svg


def _whole(reports: Sequence[Report], title: str, remarks: Sequence[str], look: Look, *, printed: bool) -> str:
    numbers = iter(range(1_000_000))
    sections = tuple(_section(report, place, look, numbers) for place, report in enumerate(reports))
    css, sections = ("", sections) if printed else _with_classes(sections)
    named = {color: f"c{color[1:]}" for color in sorted(set(_COLOR.findall(css)) - {INK_NAME, GRID_NAME})}
    for old, new in {
        INK_NAME: "var(--ink)",
        GRID_NAME: "var(--grid)",
        **{c: f"var(--{n})" for c, n in named.items()},
    }.items():
        css = css.replace(old, new)
    values = [(name, color_of(color)) for color, name in named.items()]
    return _environment().get_template("page.html.jinja").render(
        title=title or sections[0].title, sections=sections, remarks=remarks, printed=printed, css=css,
        light="".join(f"--{name}:{text_of(readable(color, LIGHT))};" for name, color in values),
        dark="".join(f"--{name}:{text_of(readable(color, DARK))};" for name, color in values),
        version=reports[0].version, shown_notes=NOTES, script=_read("page.js"), sheet=_read("page.css"),
    )  # fmt: skip


def _section(report: Report, place: int, look: Look, numbers: Iterator[int]) -> Section:
    first = report.figure
    shown = None if first is None else picture(first, look, f"f{next(numbers):x}-", apart=look is PAGE)
    ordered = sorted(report.drawn, key=lambda one: one.tab.startswith(OVERVIEW))  # the answer's own notes first
    notes = [str(one.item) for one in ordered if isinstance(one.item, str)]
    known = set(report.answer.sentences)
    return Section(
        report.title, f"run-{place}", report, shown, tuple(_parts(report, f"run-{place}", look, numbers)),
        tuple(note for note in dict.fromkeys(notes) if note not in known),
    )  # fmt: skip


def _parts(report: Report, name: str, look: Look, numbers: Iterator[int]) -> Iterator[Part]:
    tabs = list(dict.fromkeys(one.tab for one in report.drawn))
    for place, tab in enumerate(sorted(tabs, key=lambda tab: tab.startswith(OVERVIEW))):  # the answer's own parts first
        own = [one for one in report.drawn if one.tab == tab]
        kept, more = _most([drawing for _, drawing in drawings(own)])
        pictures = tuple(picture(drawing, look, f"f{next(numbers):x}-", apart=look is PAGE) for drawing in kept)
        tables = tuple(one.item for one in own if isinstance(one.item, Table) and one.item.rows)
        if pictures or tables:
            yield Part(tab, f"{name}-{place}", pictures, tables, more)


def _most(items: Sequence[Drawing]) -> tuple[list[Drawing], str]:
    """Return the pictures that a tab of a page shows, and what more there is."""
    figures = [item for item in items if isinstance(item, Figure)]
    series = [item for item in items if isinstance(item, Series)]
    tracks = [item for item in items if not isinstance(item, Figure | Series)]
    rest = [f"{len(series) - MOST_SERIES} more series"] if len(series) > MOST_SERIES else []
    rest += [f"{len(group) - MOST_TRACKS} more tracks" for group in tracks if len(group) > MOST_TRACKS]
    kept = [*figures, *(group[:MOST_TRACKS] for group in tracks), *series[:MOST_SERIES]]
    return kept, f"The recording has {' and '.join(rest)}." if rest else ""


def _with_classes(sections: Sequence[Section]) -> tuple[str, tuple[Section, ...]]:
    """Return a style sheet, and sections whose pictures use it."""
    pictures = [
        p
        for s in sections
        for p in (*((s.figure,) if s.figure else ()), *(p for part in s.parts for p in part.pictures))
    ]
    css, short = with_classes([svg for p in pictures for svg in (p.svg, *(sample for sample, _ in p.legend))])
    rest = iter(short)
    changed = {
        id(p): replace(p, svg=next(rest), legend=tuple((next(rest), label) for _, label in p.legend)) for p in pictures
    }
    return css, tuple(
        replace(
            s, figure=changed[id(s.figure)] if s.figure else None,
            parts=tuple(replace(part, pictures=tuple(changed[id(p)] for p in part.pictures)) for part in s.parts),
        )
        for s in sections
    )  # fmt: skip


def _read(name: str) -> str:
    return resources.files("imuwb.review.page").joinpath(name).read_text("utf-8")


def _size(table: Table) -> str:
    """Return how wide a table is on paper: "", "wide" or "widest"."""
    widths = [
        max(min(len(heading), WORD), *(len(row[i]) for row in table.rows if i < len(row)), 0)
        for i, heading in enumerate(table.headings)
    ]
    letters = sum(min(width, LONG_CELL) + 2 for width in widths)
    return "" if letters <= PAPER_LETTERS else "wide" if letters <= 1.25 * PAPER_LETTERS else "widest"


def _states_units(value: Any) -> bool:  # noqa: ANN401 - jinja calls it with any value
    """Return whether a row of an answer states the units of the rows above it."""
    return not value[0] and any(cell in UNITS for cell in value)


def _shown(value: Any) -> Any:  # noqa: ANN401 - jinja calls it with any value
    """Return a value as the page shows it: a text printable, markup as it is."""
    return printable_lines(value) if isinstance(value, str) and not hasattr(value, "__html__") else value


@cache
def _environment() -> Environment:
    environment = Environment(
        loader=FunctionLoader(_read), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True,
        finalize=_shown,
    )  # fmt: skip
    environment.filters["size"] = _size
    environment.tests["units"] = _states_units
    return environment

"""The figures and tables of reports as files, each with a name that says what it shows."""

import re
import unicodedata
from collections.abc import Iterator, Sequence

from imuwb.analysis import Table
from imuwb.review.page.report import Report
from imuwb.review.tables.columns import answer_table
from imuwb.review.tables.files import TABLE_FORMATS

FIGURE_FORMATS = ("png", "pdf", "svg")
LONGEST = 90  #: letters of a name
_RANGE = re.compile(r",? -?[\d.]+ to -?[\d.]+$")  #: of the values of a chart, in its title: no name of what it shows


def table_files(reports: Sequence[Report], form: str) -> dict[str, bytes]:
    """Return {file name: content} of the answer's table and of all tables, as csv, latex or md."""
    suffix, text = TABLE_FORMATS[form]
    found = [((f"{report.analysis} {tab}", name), table) for report in reports for tab, name, table in _tables(report)]
    names = _names([name for name, _ in found])
    return {f"{name}{suffix}": text(table).encode("utf-8") for name, (_, table) in zip(names, found, strict=True)}


def figure_files(reports: Sequence[Report], form: str) -> dict[str, bytes]:
    """Return {file name: content} of all figures, series and tracks for white paper, as png, pdf or svg."""
    from imuwb.review.page.canvas import render  # noqa: PLC0415 - matplotlib takes half a second
    from imuwb.review.page.pictures import drawings, title_of  # noqa: PLC0415
    from imuwb.review.page.themes import PAPER  # noqa: PLC0415

    found = [
        ((f"{report.analysis} {tab}", title_of(drawing)), drawing)
        for report in reports
        for tab, drawing in (*((("", report.figure),) if report.figure else ()), *drawings(report.drawn))
    ]
    names = _names([name for name, _ in found])
    return {f"{name}.{form}": render(drawing, PAPER, form) for name, (_, drawing) in zip(names, found, strict=True)}


def _tables(report: Report) -> Iterator[tuple[str, str, Table]]:
    """Yield tab, title and table."""
    if report.answer.rows:
        yield "", "answer", answer_table(report.answer, report.title)
    for one in report.drawn:
        if isinstance(one.item, Table) and one.item.rows:
            yield one.tab, one.item.title, one.item


def _names(texts: Sequence[tuple[str, str]]) -> list[str]:
    """Return names of files for (analysis and tab, title): letters, digits and hyphens; equal ones are numbered."""
    names: list[str] = []
    for context, title in texts:
        before = list(dict.fromkeys(_words(context)))
        words = (
            *before,
            *(word for word in _words(_RANGE.sub("", title)) if word.isdigit() or word not in before),
        )  # "allan" is said once
        name = own = "-".join(words)[:LONGEST].rstrip("-") or "figure"
        number = 1
        while own in names:
            number += 1
            own = f"{name}-{number}"
        names.append(own)
    return names


def _words(text: str) -> list[str]:
    plain = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode().lower()
    return re.findall(r"[a-z0-9]+", plain)

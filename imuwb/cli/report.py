"""imuwb report: one page of several analyses, from their recordings."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from imuwb.cli.options import FigureFormat, Figures, Force, Pdf, TableFormat, Tables, output_option
from imuwb.errors import UnreadableLogError, UsageError
from imuwb.texts import names_text

if TYPE_CHECKING:
    from imuwb.review.page.report import Report
    from imuwb.review.recording.recorded import Recorded

LOST = {".json": "the JSON of a result", ".html": "a page", ".toml": "an error model"}


def report(
    *,
    recordings: Annotated[
        list[Path],
        typer.Argument(
            help="Recordings of imuwb, in the order of the page: noise, temperature, outage, ...", metavar="REC.rrd"
        ),
    ],
    output: Annotated[Path, output_option("--output", "-o", text="Page to write.", metavar="FILE.html")] = Path(
        "report.html"
    ),
    title: Annotated[str | None, typer.Option(help="Title of the page. Default: the names of the analyses.")] = None,
    force: Force = False,
    pdf: Pdf = None,
    figures: Figures = None,
    figure_format: FigureFormat = None,
    tables: Tables = None,
    table_format: TableFormat = None,
) -> None:
    """Make one page of several analyses of a sensor or a drive, from their recordings.

    Each part has the answer, the figures and tables of its run, the log it is of, and the command that makes it again. The page
    states whether the parts are of one log.

    Example: imuwb report static.rrd chamber.rrd drive.rrd -o sensor.html
    """
    from imuwb.analysis import Answer  # noqa: PLC0415 - help must not wait for numpy and rerun
    from imuwb.cli.page_files import PageFiles  # noqa: PLC0415
    from imuwb.cli.places import reserved  # noqa: PLC0415
    from imuwb.cli.terminal import print_panel, progress  # noqa: PLC0415
    from imuwb.review.answers.panel import Origin  # noqa: PLC0415

    files = PageFiles(output, pdf, figures, figure_format, tables, table_format)
    files.check(force=force)
    with reserved(files.files, recordings, force=force):
        recorded = [_read(path) for path in recordings]
        check_runs(recorded)
        reports = [report for _, report in recorded]
        remarks = remarks_on(recorded)
        with progress(f"writing {output.name}"):
            wrote = files.write(reports, title or title_of(reports), remarks)
    rows = tuple((r.analysis, r.sources[0].name if r.sources else "", *r.answer.sentences[:1]) for r in reports)
    count = f"{len(reports)} {'analysis' if len(reports) == 1 else 'analyses'}"
    print_panel(
        Answer(count, rows=rows, sentences=remarks),
        Origin("report", tuple(map(str, recordings)), wrote=wrote),
        data=True,
    )


def _read(path: Path) -> tuple[Recorded, Report]:
    """Return a recording, and what its page shows.

    Raises:
        UnreadableLogError: the file is no recording of imuwb, or has no page.
    """
    from imuwb.cli.terminal import progress  # noqa: PLC0415 - as above
    from imuwb.cli.view import check_recording  # noqa: PLC0415

    if path.suffix in LOST and path.is_file():
        raise UnreadableLogError(
            f"{path}: this is {LOST[path.suffix]}, which has no figures; give the recording (.rrd) of the same run"
        )
    check_recording(path)
    with progress(f"reading {path.name}"):
        from imuwb.review.page.report_document import KEPT, report_from  # noqa: PLC0415 - as above
        from imuwb.review.recording.recorded import read  # noqa: PLC0415

        recorded = read(path)
    if recorded.foreign:
        raise UnreadableLogError(
            f"{path}: another program made this recording; imuwb report takes those of its analyses"
        )
    if KEPT not in recorded.texts:
        raise UnreadableLogError(
            f"{path}: this recording keeps no page: it is of no analysis, or of an older imuwb; run the analysis again"
        )
    return recorded, report_from(recorded.texts[KEPT], path)


def check_runs(recorded: Sequence[tuple[Recorded, Report]]) -> None:
    """Raise UsageError if two recordings are of one run."""
    known: dict[str, Path] = {}
    for one, report in recorded:
        if (other := known.get(report.run)) is not None:
            raise UsageError(f"{other} and {one.path} are of the same run, {report.run}; give each run once")
        known[report.run] = one.path


def title_of(reports: Sequence[Report]) -> str:
    """Return the analyses and the logs of a page: "Noise, outage: static.mcap, drive.mcap"."""
    analyses = ", ".join(dict.fromkeys(report.analysis for report in reports))
    logs = names_text(list(dict.fromkeys(source.name for report in reports for source in report.sources)), 3)
    return f"{analyses.capitalize()}: {logs}"


def remarks_on(recorded: Sequence[tuple[Recorded, Report]]) -> tuple[str, ...]:
    """Return what a reader must know of several runs together: whether they are of one log and one sensor, and of one imuwb."""
    logs: dict[frozenset[str], list[str]] = {}
    sensors: dict[frozenset[str], list[str]] = {}
    for one, report in recorded:
        logs.setdefault(frozenset(source.hash for source in report.sources), []).append(report.title)
        sensors.setdefault(_names(one.properties), []).append(report.title)
    remarks: list[str] = []
    if len(logs) > 1:
        remarks.append(f"The parts are of different logs: {_grouped(logs.values())}.")
        named = {names: titles for names, titles in sensors.items() if names}
        if len(named) > 1:
            each = "; ".join(f"{', '.join(sorted(names))} ({', '.join(titles)})" for names, titles in named.items())
            remarks.append(f"The logs name different IMUs: {each}. Check that they are of one sensor.")
        else:
            remarks.append("No log states the serial number of its sensor: check that they are of one sensor.")
    versions = sorted({report.version for _, report in recorded})
    if len(versions) > 1:
        remarks.append(f"They were made with imuwb {', '.join(versions)}: estimates may differ for that reason alone.")
    return tuple(remarks)


def _names(properties: Mapping[str, object]) -> frozenset[str]:
    value = properties.get("sensor", ())
    return frozenset([value] if isinstance(value, str) else map(str, value) if isinstance(value, list | tuple) else ())


def _grouped(groups: Iterable[Sequence[str]]) -> str:
    return "; ".join(" and ".join(group) for group in groups)

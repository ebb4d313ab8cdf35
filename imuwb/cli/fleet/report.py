"""imuwb fleet report: what the tables of a fleet say, in words, as a recording, a page and JSON."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from imuwb.cli.options import FigureFormat, Figures, Force, Full, Html, Pdf, TableFormat, Tables, output_option
from imuwb.errors import ImuwbError, MissingDataError, UsageError

if TYPE_CHECKING:
    import pyarrow as pa

    from imuwb.analysis import Answer, Table
    from imuwb.cli.page_files import PageFiles
    from imuwb.fleet.report.result import FleetReport
    from imuwb.fleet.report.sheet import SheetVerdict
    from imuwb.fleet.run_state import RunState
    from imuwb.review.answers.panel import Origin
    from imuwb.review.page.report import Report

PANELS: dict[str, str] = {}
RESULTS, LIMITS = "The results", "Limits"
NAME = "fleet report"
_Results = Annotated[
    str,
    typer.Argument(
        help="Folder of the results of imuwb fleet, also in a store (s3://bucket/results/).", metavar="RESULTS", rich_help_panel=RESULTS
    ),
]  # fmt: skip
_Check = Annotated[
    Path | None,
    typer.Option(
        "--check", help="Data sheet or limits for the family and for each sensor, as in imuwb model check. Exit code 1: one is exceeded, or may be.",
        metavar="FILE.toml", rich_help_panel=LIMITS,
    ),
]  # fmt: skip
_MaxQuarantine = Annotated[
    str | None,
    typer.Option("--max-quarantine", help="Exit code 1 if more logs are in quarantine.", metavar="PER CENT", rich_help_panel=LIMITS),
]  # fmt: skip
_Error = Annotated[
    float,
    typer.Option("--error", help="Probability that chance makes any finding in a fleet without any such sensor.", rich_help_panel=RESULTS),
]  # fmt: skip
_Level = Annotated[float, typer.Option("--level", help="Probability of the intervals.", rich_help_panel=RESULTS)]
_Doubtful = Annotated[
    bool,
    typer.Option("--with-doubtful", help="Also count values that a remark puts in doubt.", rich_help_panel=RESULTS),
]
_Output = Annotated[
    Path | None,
    output_option("--output", "-o", text="Recording to write. Default: report.rrd in the folder of the results.", metavar="FILE.rrd"),
]  # fmt: skip
_Json = Annotated[
    str | None, output_option("--json", text="Write the result as JSON to a file; - for stdout.", metavar="FILE")
]


def report(
    *, results: _Results, check: _Check = None, max_quarantine: _MaxQuarantine = None, error: _Error = 0.01, level: _Level = 0.95,
    with_doubtful: _Doubtful = False, output: _Output = None, force: Force = False, html: Html = None, pdf: Pdf = None,
    figures: Figures = None, figure_format: FigureFormat = None, tables: Tables = None, table_format: TableFormat = None,
    json: _Json = None, full: Full = False,
) -> None:  # fmt: skip
    """Say which sensors are out of family, which change from log to log, and which logs are worthless.

    The family of each coefficient and its spread come from all logs by random effects. Each finding names the command that shows its log.

    Example: imuwb fleet report results/ --html fleet.html --check datasheet.toml --max-quarantine 1%
    """
    from imuwb.cli.page_files import PageFiles  # noqa: PLC0415 - help must not wait
    from imuwb.cli.places import reserved  # noqa: PLC0415
    from imuwb.cli.terminal import print_panel, progress, shower  # noqa: PLC0415
    from imuwb.stochastic.model_check import limits  # noqa: PLC0415

    most = _share(max_quarantine)
    for name, value in (("--error", error), ("--level", level)):
        if not 0 < value < 1:
            raise UsageError(f"{name} is {value}; it must be above 0 and below 1")
    wanted = limits(check) if check is not None else ()
    recording = output or _default(results)
    if recording.suffix != ".rrd":
        raise UsageError(f"--output {recording}: the name of a recording must end in .rrd")
    document = Path(json) if json not in (None, "-") else None
    pages = PageFiles(html, pdf, figures, figure_format, tables, table_format)
    pages.check(force=force)
    with progress("reading the results"):
        from imuwb.fleet.report.result import fleet_report  # noqa: PLC0415 - the first line must not wait for it
        from imuwb.fleet.report.sheet import against  # noqa: PLC0415

        state, read = _read(results)
    files = [recording, *pages.files, *([document] if document else [])]
    with reserved(files, [] if check is None else [check], force=force):
        found = fleet_report(
            state, read, error=error, level=level, doubtful=with_doubtful, sheet=bool(wanted), options=_options(state)
        )
        verdicts = against(found, wanted)
        text, said, origin, shown = _written(found, verdicts, results, recording, pages, document)
    # All files are written before the first line is printed: the program that reads the output may end at any time.
    if json == "-":
        typer.echo(text)
    show = shower(data=json != "-")
    for item in shown if full else ():
        show(item)
    print_panel(said, origin, data=json != "-")
    _check_limits(found, verdicts, check, most)


def _default(results: str) -> Path:
    """Return the place of the recording: in the folder of the results, or in the working folder if they are in a store."""
    from imuwb.readers.bytes.address import is_address  # noqa: PLC0415 - help must not wait

    return Path("report.rrd") if is_address(results) else Path(results) / "report.rrd"


def _options(state: RunState) -> str:
    """Return the options of the analysis that differ from their defaults, as words of a command; empty if it is not installed here."""
    from imuwb.cli.analyses import analysis_named  # noqa: PLC0415 - help must not wait
    from imuwb.cli.typed import options_given  # noqa: PLC0415

    known = {name: value for name, value in state.params.items() if name != "method"}
    try:
        return " ".join(options_given(analysis_named(state.analysis).Parameters(**known)))
    except (ImuwbError, TypeError, ValueError):
        return ""


def _share(text: str | None) -> float:
    """Return a share of the logs from per cent.

    Raises:
        UsageError: it is none.
    """
    if text is None:
        return math.inf
    try:
        value = float(text.strip().removesuffix("%"))
    except ValueError:
        value = math.nan
    if not text.strip().endswith("%") or not 0 <= value <= 100:  # noqa: PLR2004 - all
        raise UsageError(f"--max-quarantine {text}: write per cent of the logs from 0% to 100%, such as 1%")
    return value / 100


def _read(results: str) -> tuple[RunState, dict[str, pa.Table]]:
    """Return what was run, and its tables.

    Raises:
        UsageError: the folder has no results, or those of another version, or a table lacks columns or is of another run.
        MissingDataError: the run has not ended.
    """
    from imuwb.fleet.run_state import run_state  # noqa: PLC0415 - help must not wait
    from imuwb.fleet.schemas import TABLES, file_of  # noqa: PLC0415
    from imuwb.fleet.store import store_at  # noqa: PLC0415
    from imuwb.fleet.tables import read_table  # noqa: PLC0415

    store = store_at(results)
    state = run_state(store, results, reading=True)
    if state is None:
        raise UsageError(
            f"{results}: there is no run.json, so this is no folder of results; imuwb fleet ANALYSIS LOGS -o {results} makes one"
        )
    tables = {name: read_table(store, name, results) for name in TABLES}
    missing = [file_of(name) for name, table in tables.items() if table is None]
    if missing:
        raise MissingDataError(
            f"{results}: {', '.join(missing)}: not there, the run is {state.state}; the same imuwb fleet command goes on and writes them"
        )
    found = {name: table for name, table in tables.items() if table is not None}
    _check_same_run(state, found, results)
    return state, found


def _check_same_run(state: RunState, tables: dict[str, pa.Table], results: str) -> None:
    """Raise UsageError if a table has a log that the table of logs lacks: it is of another run, or is just being written."""
    from imuwb.fleet.schemas import file_of  # noqa: PLC0415 - as above
    from imuwb.texts import printable  # noqa: PLC0415 - as above

    for name, column in (("sensors", "log"), ("outages", "log"), ("quarantine", "path")):
        known = set(tables["logs"][column].unique().to_pylist())
        foreign = [log for log in tables[name][column].unique().to_pylist() if log not in known]
        if foreign:
            why = (
                "it is a table of another run; the imuwb fleet command of this run, with --force, writes all tables anew"
                if state.state == "ended"
                else "the tables are being written, or their run was killed; wait, or give the same imuwb fleet command again"
            )
            raise UsageError(
                f"{results.rstrip('/')}/{file_of(name)}: {len(foreign)} of its logs {'is' if len(foreign) == 1 else 'are'} not in logs.parquet "
                f"(the first: {printable(str(foreign[0]))}), so {why}"
            )


def _written(
    found: FleetReport,
    verdicts: Sequence[SheetVerdict],
    results: str,
    recording: Path,
    pages: PageFiles,
    document: Path | None,
) -> tuple[str, Answer, Origin, list[Table | str]]:
    """Write recording, page and JSON; return the JSON, the answer, where it comes from, and what --full prints."""
    from imuwb.fleet.report.answer import answer  # noqa: PLC0415
    from imuwb.review.answers.panel import Origin  # noqa: PLC0415
    from imuwb.writers import write_text  # noqa: PLC0415

    said = answer(found, verdicts)
    origin = Origin(NAME, (results.rstrip("/"),))
    text, made, shown = _recorded(found, verdicts, said, origin, recording)
    wrote = pages.write([made]) if pages.wanted else ()
    if document is not None:
        write_text(document, text + "\n")
    others = (*wrote, *([str(document)] if document else []))
    return text, said, replace(origin, wrote=(f"{recording} (imuwb view)", *others)), shown


def _recorded(
    found: FleetReport, verdicts: Sequence[SheetVerdict], said: Answer, origin: Origin, recording: Path
) -> tuple[str, Report, list[Table | str]]:
    """Write the recording, and return the JSON, what a page shows, and what --full prints."""
    from imuwb import __version__  # noqa: PLC0415 - it reads the installed metadata
    from imuwb.fleet.report.document import content_of  # noqa: PLC0415 - help must not wait
    from imuwb.fleet.report.show import draw  # noqa: PLC0415
    from imuwb.review.answers.document import document as document_of  # noqa: PLC0415
    from imuwb.review.answers.panel import WHOLE_HEIGHT, panel  # noqa: PLC0415
    from imuwb.review.page.report import report_of  # noqa: PLC0415
    from imuwb.review.page.report_document import KEPT, report_from, text_of  # noqa: PLC0415
    from imuwb.review.recording.properties import properties, recording_name  # noqa: PLC0415
    from imuwb.review.recording.review import RecordingReview  # noqa: PLC0415 - the viewer's library is slow to import

    shown: list[Table | str] = []
    review = RecordingReview(recording, show=shown.append)
    try:
        draw(found, review, verdicts)
        review.summary(panel(said, origin, height=WHOLE_HEIGHT))
        settings = {"error": found.error, "level": found.level}
        text, run = document_of(NAME, __version__, settings, content_of(found, verdicts), (), review.notes)
        stated = properties(NAME, __version__, found.level, (), said, ())
        review.state(recording_name(NAME, (), said), {"run": run, **stated, "log": list(origin.logs)}, text)
        kept = text_of(report_of(said, origin, review.drawn, (), run, __version__))
        review.keep(KEPT, kept)
        made = report_from(kept, recording)
        review.close()
    except BaseException:
        review.discard()
        raise
    return text, made, shown


def _check_limits(found: FleetReport, verdicts: Sequence[SheetVerdict], sheet: Path | None, most: float) -> None:
    """Raise ImuwbError if a limit is exceeded, or may be: so it is while the run has not ended."""
    from imuwb.fleet.report.sheet import outcomes  # noqa: PLC0415 - help must not wait

    failed: list[str] = []
    if found.unfinished and (sheet is not None or math.isfinite(most)):
        failed.append(f"{found.unfinished}, so no limit can be kept yet; the same imuwb fleet command goes on")
    counts = {outcome: count for outcome, count in outcomes(verdicts).items() if outcome != "within"}
    if counts:
        first = next(one for one in verdicts if one.verdict.outcome != "within")
        limit = first.verdict.limit
        listed = ", ".join(f"{count} {outcome}" for outcome, count in counts.items())
        failed.append(
            f"not within {sheet}: {listed} of {len(verdicts)} limits; the first: {first.sensor}, {limit.axis} {limit.letter}"
        )
    if found.quarantined_share > most:
        failed.append(
            f"{found.quarantined} of {found.count} logs {'is' if found.quarantined == 1 else 'are'} in quarantine ({100 * found.quarantined_share:.3g} %), and --max-quarantine "
            f"allows {100 * most:g} %; quarantine.parquet has the reasons"
        )
    if failed:
        raise ImuwbError("; ".join(failed))

"""imuwb info: shows the streams of a log."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated, cast

import typer

from imuwb import registry
from imuwb.analysis import Step
from imuwb.cli.help import LOG, READING
from imuwb.cli.options import LOG_ARGUMENT, Full, output_option
from imuwb.errors import MissingDataError
from imuwb.health import Fault
from imuwb.log import Log
from imuwb.readers.bytes.address import place_of
from imuwb.readers.read_options import ReadOptions
from imuwb.summary import LogSummary

LARGE = 256 << 20  #: bytes; a larger log is summarized from its index, if it has one
LARGE_REMOTE = 16 << 20  #: bytes; likewise of a remote log


def info(
    log: Annotated[str, LOG_ARGUMENT],
    reading: ReadOptions,
    *,
    join: Annotated[
        list[str] | None,
        typer.Option(
            "--join",
            metavar="LOG",
            rich_help_panel=LOG,
            help="File with the gyro, the accelerometer or the temperature that the log lacks.",
        ),
    ] = None,
    full: Full = False,
    json: Annotated[bool, output_option("--json", text="Print JSON on stdout.")] = False,
    scan: Annotated[
        bool,
        typer.Option(
            "--scan",
            rich_help_panel=READING,
            help="Read every message of a log above 256 MB, or 16 MB if it is remote, not only its index.",
        ),
    ] = False,
) -> None:
    """Show the streams of a log: rates, gaps, clocks, units, frames and repairs.

    Example: imuwb info flight.bin
    """
    from imuwb.cli.reading import joined_sensors, read_log  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.cli.typed import options_given  # noqa: PLC0415
    from imuwb.readers.bytes import source  # noqa: PLC0415
    from imuwb.readers.reading import indexed  # noqa: PLC0415
    from imuwb.review.tables.contents import can_be_used  # noqa: PLC0415
    from imuwb.summary import summarize  # noqa: PLC0415

    with source.accessed(log) as place:
        local = isinstance(place, Path)
        if not local or not place.is_dir():
            source.check(place)
        small = source.size(place) <= (LARGE if local else LARGE_REMOTE)
        stated = None if scan or small or join else indexed(place, reading)
        whole = read_log(place, reading) if stated is None else None
    if whole is not None and join:
        whole = joined_sensors(whole, reading, join)
    summary = stated or summarize(cast("Log", whole))
    if json:
        from imuwb.review.answers.document import json_text  # noqa: PLC0415 - only here

        typer.echo(json_text(summary))
    else:
        read = (
            str(place_of(log)),
            *options_given(reading),
            *(word for file in join or () for word in ("--join", file)),
        )
        _show(summary, whole, read, full=full)
    if not can_be_used(summary):
        raise MissingDataError(f"{summary.path}: {_why(summary)}")


def _why(summary: LogSummary) -> str:
    """Return why nothing in a log can be used."""
    if summary.streams:
        kinds = ", ".join(dict.fromkeys(stream.kind for stream in summary.streams))
        return f"nothing in this file can be used: it has only {kinds}, and neither an IMU, a receiver, a speed nor a trajectory"
    why = "the notes say what it contains" if summary.notes else "it contains nothing that imuwb reads"
    return f"nothing in this file can be used; {why}"


def _show(summary: LogSummary, whole: Log | None, read: Sequence[str], *, full: bool) -> None:
    """Print the answer; before it, all tables and notes if they are wanted. ``read``: the log, and how it is read."""
    from imuwb.cli.terminal import print_panel, shower  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.review.answers.log_answer import log_answer  # noqa: PLC0415
    from imuwb.review.answers.panel import Origin  # noqa: PLC0415
    from imuwb.review.tables.contents import contents_table, usable_table  # noqa: PLC0415
    from imuwb.review.tables.streams import truth_table  # noqa: PLC0415

    if full:
        show = shower(data=True)
        for table in (usable_table(summary, whole), contents_table(summary)) if summary.streams else ():
            show(table)
        for note in summary.notes:
            show(note)
        if summary.truth:
            show(truth_table(summary))
    faults = None if whole is None else faults_of(whole)
    answer = log_answer(summary, whole, faults, tuple(_steps(summary, faults or ())))
    print_panel(answer, Origin("log", (read[0],), options=tuple(read[1:])), data=True)


def faults_of(log: Log) -> tuple[Fault, ...]:
    """Return what is wrong with the clocks and the receivers of a log, the worst first."""
    from imuwb.health import check  # noqa: PLC0415 - help must not wait for numpy

    return tuple(check(log, samples=False).faults)


def _steps(summary: LogSummary, faults: Sequence[Fault]) -> Iterator[Step]:
    """Yield what can be done next: look at the faults, or analyse the log."""
    from imuwb.cli.next_steps import analysis_steps  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.review.tables.contents import ALONE  # noqa: PLC0415

    kinds = {stream.kind for stream in summary.streams}
    counts = {severity: sum(fault.severity == severity for fault in faults) for severity in ("fault", "warning")}
    found = [f"{n} {word}{'s' * (n > 1)}" for word, n in counts.items() if n]
    shows_all = registry.marked(registry.ANALYSES, "SHOWS_FAULTS", value=True)
    if shows_all and kinds & set(ALONE):
        worst = next((f"; the worst: {fault.stream}: {fault.what}" for fault in faults[:1] if found), "")
        yield Step(
            f"imuwb {shows_all[0]} {{log}}",
            f"{' and '.join(found)}{worst}" if found else "whether its samples are sound",
        )
    if not found:
        yield from analysis_steps(kinds)

"""imuwb info: shows the streams of a log."""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, cast

import typer

from imuwb import registry
from imuwb.analysis import Table
from imuwb.cli.help import LOG, READING
from imuwb.cli.options import LOG_ARGUMENT, output_option
from imuwb.errors import MissingDataError
from imuwb.log import Log
from imuwb.readers.read_options import ReadOptions
from imuwb.summary import LogSummary

LARGE = 256 << 20  #: bytes; a larger log is summarized from its index, if it has one
NAMED = 3  #: faults that the last line names, at most
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
    from imuwb.cli.terminal import shower  # noqa: PLC0415
    from imuwb.readers.bytes import source  # noqa: PLC0415
    from imuwb.readers.reading import indexed  # noqa: PLC0415
    from imuwb.review.contents import can_be_used, contents_table, usable_table  # noqa: PLC0415
    from imuwb.review.tables import truth_table  # noqa: PLC0415
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
        from imuwb.review.document import json_text  # noqa: PLC0415 - only here

        typer.echo(json_text(summary))
    else:
        show = shower(data=True)
        if summary.streams:
            show(usable_table(summary, whole))
            show(contents_table(summary))
        for note in summary.notes:
            show(note)
        if summary.truth:
            show(truth_table(summary))
        if whole is not None:
            show_faults(whole, show)
    if not can_be_used(summary):
        raise MissingDataError(f"{summary.path}: {_why(summary)}")


def _why(summary: LogSummary) -> str:
    """Return why nothing in a log can be used."""
    if summary.streams:
        kinds = ", ".join(dict.fromkeys(stream.kind for stream in summary.streams))
        return f"nothing in this file can be used: it has only {kinds}, and neither an IMU, a receiver, a speed nor a trajectory"
    why = "the notes say what it contains" if summary.notes else "it contains nothing that imuwb reads"
    return f"nothing in this file can be used; {why}"


def show_faults(log: Log, show: Callable[[Table | str], None]) -> None:
    """State how many faults a log has, and the worst: the faults, or else the first warning."""
    from imuwb.health import check  # noqa: PLC0415 - help must not wait for numpy

    found = [fault for fault in check(log, samples=False).faults if fault.severity != "note"]
    if found:
        grave = [fault for fault in found if fault.severity == "fault"] or found[:1]
        named = dict.fromkeys(f"{f.stream}: {f.what}" + (f" ({f.count} times)" if f.count > 1 else "") for f in grave)
        worst = "; ".join(list(named)[:NAMED]) + ("; ..." if len(named) > NAMED else "")
        shows_all = registry.marked(registry.ANALYSES, "SHOWS_FAULTS", value=True)
        command = f"; imuwb {shows_all[0]} shows all" if shows_all else ""
        show(f"{len(found)} faults and warnings; the worst: {worst}{command}")

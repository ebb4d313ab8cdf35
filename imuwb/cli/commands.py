"""The commands that are no analysis: info, convert, view, plugins, demo."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, cast

import typer

from imuwb import registry
from imuwb.cli.common import ANY_LOG, IMU_HELP, Common
from imuwb.errors import ImuwbError, MissingDataError, UsageError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from imuwb.analysis import Analysis, Table
    from imuwb.log import Log

LOGS, RESULTS = "Logs", "Results"
KINDS = (("analysis", registry.ANALYSES), ("conditioner", registry.CONDITIONERS), ("reader", registry.READERS))
DEMO = "noise", "outage"
DEMO_LOGS = "static.mcap", "drive.mcap"  #: a still one, and one that moves
LARGE = 256 << 20  #: bytes; from here on an index, where there is one, tells what a log holds


def info(
    log: Annotated[Path, typer.Argument(help=ANY_LOG, metavar="LOG")],
    *,
    json: Annotated[bool, typer.Option("--json", help="As JSON on stdout.")] = False,
    scan: Annotated[bool, typer.Option("--scan", help="Read every message of a large log too, not its index.")] = False,
    time_source: Annotated[
        Literal["header", "log", "publish"], typer.Option(help="Which stamp of a message counts.")
    ] = "header",
    rate: Annotated[float | None, typer.Option(help="Of text without a time column.", metavar="HZ")] = None,
    columns: Annotated[
        str | None, typer.Option(help="Of text without a header: names in order, - for none.", metavar="NAMES")
    ] = None,
    units: Annotated[str | None, typer.Option(help="Such as gyro=deg/s,accel=g,time=ms.", metavar="UNITS")] = None,
    frame: Annotated[Literal["FRD", "FLU"] | None, typer.Option(help="Body frame, where the log does not say.")] = None,
) -> None:
    """Streams, rates, gaps, clocks, units, frames and repairs of a log."""
    from imuwb import readers  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.cli.terminal import shower  # noqa: PLC0415
    from imuwb.readers.bytes import source  # noqa: PLC0415
    from imuwb.review.document import plain  # noqa: PLC0415
    from imuwb.review.tables import streams_table  # noqa: PLC0415

    common = Common(time_source=time_source, rate=rate, columns=columns, units=units, frame=frame)
    source.check(log)
    large = log.stat().st_size > LARGE
    read = None
    if not large or scan:
        from imuwb.cli.perform import read_log  # noqa: PLC0415 - an index alone must not wait for the viewer's library

        read = read_log(log, common)
    summary = readers.describe(log) if read is None else readers.summarize(read)
    if json:
        import json as json_module  # noqa: PLC0415 - the option has its name

        typer.echo(json_module.dumps(plain(summary), indent=1, ensure_ascii=False))
        return
    show = shower(data=True)
    show(streams_table(summary))
    for note in (*summary.notes, *(() if summary.streams else ("nothing in this log is of a kind that imuwb reads",))):
        show(note)
    if read is not None:
        show_faults(read, show)


def show_faults(log: Log, show: Callable[[Table | str], None]) -> None:
    """Say how many faults there are, and the worst; ``imuwb health`` tells them all."""
    from imuwb.health import check  # noqa: PLC0415 - help must not wait for numpy

    found = [fault for fault in check(log, samples=False).faults if fault.severity != "note"]
    if found:
        worst = found[0]
        said = f"{worst.stream}: {worst.what}{f' ({worst.count})' if worst.count > 1 else ''}"
        show(f"{len(found)} faults or warnings, the worst: {said}; imuwb health tells all")


def convert(
    log: Annotated[Path, typer.Argument(help=ANY_LOG, metavar="LOG")],
    *,
    output: Annotated[
        Path,
        typer.Option("--output", "-o", help="The new log; its suffix, .mcap or .csv, is its format.", metavar="FILE"),
    ],
    imu: Annotated[str | None, typer.Option("--imu", help=IMU_HELP, metavar="NAME|A+B")] = None,
    start: Annotated[str | None, typer.Option(help="From here on: seconds from the log's start, or ISO.")] = None,
    end: Annotated[str | None, typer.Option(help="Up to here.")] = None,
    time_source: Annotated[
        Literal["header", "log", "publish"], typer.Option(help="Which stamp of a message counts.")
    ] = "header",
    rate: Annotated[float | None, typer.Option(help="Of text without a time column.", metavar="HZ")] = None,
    columns: Annotated[
        str | None, typer.Option(help="Of text without a header: names in order, - for none.", metavar="NAMES")
    ] = None,
    units: Annotated[str | None, typer.Option(help="Such as gyro=deg/s,accel=g,time=ms.", metavar="UNITS")] = None,
    frame: Annotated[Literal["FRD", "FLU"] | None, typer.Option(help="Body frame, where the log does not say.")] = None,
    gnss: Annotated[Path | None, typer.Option(help="A file of its own with the receiver's fixes.")] = None,
    force: Annotated[bool, typer.Option("--force", help="Write over files that exist.")] = False,
) -> None:
    """Write a log as MCAP (ROS 2 messages) or as CSV with units in its names: all streams, or a part in time."""
    from imuwb.cli.perform import check_places, read_log  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.cli.terminal import progress, shower  # noqa: PLC0415
    from imuwb.writers import SUFFIXES, places, write  # noqa: PLC0415

    if output.suffix not in SUFFIXES:
        message = f"--output {output}: a log is written as {' or '.join(SUFFIXES)}"
        raise UsageError(message)
    common = Common(
        imu=imu,
        start=start,
        end=end,
        time_source=time_source,
        rate=rate,
        columns=columns,
        units=units,
        frame=frame,
        gnss=gnss,
    )
    sources = [log, *([gnss] if gnss is not None else [])]
    check_places([output], sources, force=force)
    found = read_log(log, common)
    found.streams()
    files = places(found, output)
    check_places(files, sources, force=force)
    show = shower(data=False)
    for note in (*found.notes, *baked_in(found)):
        show(note)
    with progress(f"writing {output.name}") as report:
        write(found, output, report)
    for file in files:
        typer.echo(f"wrote {file}", err=True)


def baked_in(log: Log) -> Iterator[str]:
    """Yield what a log that is written holds for good: what the reader mended, and heights that are none above WGS 84."""
    from imuwb.log import MEAN_SEA_LEVEL  # noqa: PLC0415 - help must not wait for numpy

    for stream in (*log.imus, *log.gnss, *log.references):
        for repair in stream.origin.repairs:
            yield f"{stream.name}: {repair.what} ({repair.count})"
    for stream in (*log.gnss, *log.references):
        if stream.origin.above_sea:
            yield f"{stream.name}: heights are written as they are, {MEAN_SEA_LEVEL}, and the new file says so"


def view(recording: Annotated[Path, typer.Argument(help="A recording that imuwb wrote.", metavar="REC.rrd")]) -> None:
    """Open a recording in the Rerun viewer, on this machine only."""
    from imuwb.cli.perform import check_recording  # noqa: PLC0415 - help must not wait

    check_recording(recording)
    # CI tells the viewer to send no usage statistics; it has no option for that.
    environment = {**os.environ, "CI": "true"}
    command = [sys.executable, "-m", "rerun", str(recording), "--bind", "127.0.0.1"]
    done = subprocess.run(command, env=environment, check=False)  # noqa: S603 - our own interpreter, a checked file
    if done.returncode:
        message = f"the viewer ended with code {done.returncode}; does this machine have a screen?"
        raise ImuwbError(message)


def plugins() -> None:
    """The analyses, conditioners (with their parameters) and readers that are installed, and where they come from."""
    from imuwb.analysis import Table  # noqa: PLC0415 - help must not wait for rich
    from imuwb.cli.terminal import shower  # noqa: PLC0415

    rows: list[tuple[str, ...]] = []
    for kind, group in KINDS:
        for name, point in registry.installed(group).items():
            loaded = registry.load(point)
            lines = (getattr(loaded, "__doc__", None) or "").strip().splitlines()
            text = lines[0] if lines else "cannot be loaded"
            if kind == "conditioner" and loaded is not None:
                text += f" ({', '.join(f.name for f in fields(cast('Any', loaded).Parameters))})"
            origin = f"{point.dist.name} {point.dist.version}" if point.dist is not None else "unknown"
            rows.append((kind, name, text, point.value, origin))
    headings = ("kind", "name", "what it does", "module", "from")
    shower(data=True)(Table("Plugins", headings, tuple(rows), "A single .py file is a plugin too: imuwb ./mine.py LOG"))


def demo(
    *,
    output: Annotated[
        Path,
        typer.Option(
            "--output", "-o", help="The noise's recording; -drive is put behind the other's name.", metavar="FILE.rrd"
        ),
    ] = Path("imuwb-demo.rrd"),
    force: Annotated[bool, typer.Option("--force", help="Write over recordings that exist.")] = False,
) -> None:
    """Identify the noise of a still sample log, and replay GNSS outages of a drive with the error model found."""
    from imuwb.cli.parameters import make  # noqa: PLC0415 - help must not wait
    from imuwb.cli.perform import Places, check_places, perform  # noqa: PLC0415

    noise, outage = (cast("Analysis", registry.load(registry.installed(registry.ANALYSES)[name])) for name in DEMO)
    still, drive = samples() / DEMO_LOGS[0], samples() / DEMO_LOGS[1]
    common = Common(output=output, force=force)
    places = Places.of(noise, [still], common)
    driven = output.with_name(f"{output.stem}-drive.rrd")
    check_places([*places.all(), driven], [still, drive], force=force)
    perform("noise", noise, [still], make(noise.Parameters, {}), common)
    parameters = make(outage.Parameters, {"error_model": places.model})
    perform("outage", outage, [drive], parameters, Common(output=driven, force=force))
    typer.echo(f"look at them: imuwb view {output}, imuwb view {driven}", err=True)


def samples() -> Path:
    """Return the folder of sample logs: in the package, or beside it in a checkout.

    Raises:
        MissingDataError: neither is there.
    """
    package = Path(__file__).resolve().parent.parent
    for folder in (package / "samples", package.parent / "samples"):
        if all((folder / log).is_file() for log in DEMO_LOGS):
            return folder
    message = f"the sample logs are not installed (looked for {package / 'samples' / DEMO_LOGS[0]})"
    raise MissingDataError(message)


#: (name, function, panel of the help)
COMMANDS: tuple[tuple[str, Callable[..., None], str], ...] = (
    ("info", info, LOGS),
    ("convert", convert, LOGS),
    ("view", view, RESULTS),
    ("plugins", plugins, RESULTS),
    ("demo", demo, RESULTS),
)

"""imuwb convert: a log written in another format."""

from __future__ import annotations

from pathlib import Path  # noqa: TC003 - the command line reads the annotations as the program runs
from typing import TYPE_CHECKING, Annotated

import typer

from imuwb.cli.options import LOG_ARGUMENT, Force, Part
from imuwb.errors import UsageError
from imuwb.readers.read_options import ReadOptions  # noqa: TC001 - as above

if TYPE_CHECKING:
    from collections.abc import Iterator

    from imuwb.log import Log


def convert(
    log: Annotated[Path, LOG_ARGUMENT],
    part: Part,
    reading: ReadOptions,
    *,
    output: Annotated[
        Path,
        typer.Option("--output", "-o", help="The new log; its suffix, .mcap or .csv, is its format.", metavar="FILE"),
    ],
    force: Force = False,
) -> None:
    """Write a log as MCAP or CSV: all streams, or a part in time.

    MCAP has ROS 2 messages; the columns of CSV have units in their names.
    """
    from imuwb.cli.places import check_places  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.cli.reading import read_log  # noqa: PLC0415
    from imuwb.cli.terminal import progress, shower  # noqa: PLC0415
    from imuwb.writers import SUFFIXES, places, write  # noqa: PLC0415

    if output.suffix not in SUFFIXES:
        message = f"--output {output}: the name of a log must end in {' or '.join(SUFFIXES)}"
        raise UsageError(message)
    sources = [log, *([part.gnss] if part.gnss is not None else [])]
    check_places([output], sources, force=force)
    content = read_log(log, reading, part)
    content.streams()
    files = places(content, output)
    check_places(files, sources, force=force)
    show = shower(data=False)
    for note in (*content.notes, *baked_in(content)):
        show(note)
    with progress(f"writing {output.name}") as report:
        write(content, output, report)
    for file in files:
        typer.echo(f"wrote {file}", err=True)


def baked_in(log: Log) -> Iterator[str]:
    """Yield what the new log contains for good: the reader's repairs, and heights that are not above WGS 84."""
    from imuwb.log import MEAN_SEA_LEVEL  # noqa: PLC0415 - help must not wait for numpy

    for stream in (*log.imus, *log.gnss, *log.references):
        for repair in stream.origin.repairs:
            yield f"{stream.name}: {repair.what} ({repair.count})"
    for stream in (*log.gnss, *log.references):
        if stream.origin.above_sea:
            yield f"{stream.name}: heights are written as they are, {MEAN_SEA_LEVEL}, and the new file states it"

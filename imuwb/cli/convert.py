"""imuwb convert: writes a log in another format."""

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

from imuwb.cli.options import LOG_ARGUMENT, Force, Full, Part, output_option
from imuwb.errors import UsageError
from imuwb.log import Log
from imuwb.readers.bytes.address import place_of
from imuwb.readers.read_options import ReadOptions


def convert(
    log: Annotated[str, LOG_ARGUMENT],
    part: Part,
    reading: ReadOptions,
    *,
    output: Annotated[
        Path,
        output_option(
            "--output", "-o", text="New log to write; its suffix, .mcap or .csv, is its format.", metavar="LOG"
        ),
    ],
    force: Force = False,
    full: Full = False,
) -> None:
    """Write all streams of a log, or a part of them, as MCAP or CSV.

    MCAP has ROS 2 messages. CSV has a file for each kind of stream, with the units in the names of the columns.

    Example: imuwb convert run.mcap -o run.csv --start 60 --end 120
    """
    from imuwb.cli.places import check_places, reserved  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.cli.reading import read_log  # noqa: PLC0415
    from imuwb.cli.terminal import progress, shower  # noqa: PLC0415
    from imuwb.cli.written import print_written  # noqa: PLC0415
    from imuwb.writers import SUFFIXES, places, write  # noqa: PLC0415

    if output.suffix not in SUFFIXES:
        raise UsageError(f"--output {output}: the name of the new log must end in {' or '.join(SUFFIXES)}")
    sources = [place_of(text) for text in (log, part.gnss) if text is not None]
    check_places([output], sources, force=force)
    content = read_log(sources[0], reading, part)
    content.streams()
    files = places(content, output)
    with reserved(files, sources, force=force), progress(f"writing {output.name}") as report:
        write(content, output, report)
    lost = (*_left_out(content, output), *baked_in(content))
    if full:
        show = shower(data=False)
        for note in (*content.notes, *lost):
            show(note)
    count = len(content.notes)
    others = (f"{count} note{'s' * (count > 1)} on what was read: --full",) if count and not full else ()
    print_written("convert", content, files, (*lost, *others))


def _left_out(log: Log, output: Path) -> Iterator[str]:
    """Yield notes on the orientations that the format cannot hold."""
    from imuwb.notes import Note  # noqa: PLC0415 - help must be fast

    if output.suffix == ".csv":
        for orientation in log.orientations:
            text = f"{orientation.name}: its orientation is not written: CSV has no columns for it; MCAP has"
            yield Note("orientation-not-written", text)


def baked_in(log: Log) -> Iterator[str]:
    """Yield notes on what the new log no longer shows: repairs of the reader, and the zero of heights."""
    from imuwb.log import MEAN_SEA_LEVEL  # noqa: PLC0415 - help must not wait for numpy

    for stream in (*log.imus, *log.gnss, *log.references):
        for repair in stream.origin.repairs:
            yield f"{stream.name}: {repair.what} ({repair.count})"
    for stream in (*log.gnss, *log.references):
        if stream.origin.above_sea:
            yield f"{stream.name}: the heights stay {MEAN_SEA_LEVEL}; the new log states this"

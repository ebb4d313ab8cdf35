"""Text logs: separated numbers, with units in the header, on the command line, or in a sidecar."""

from collections.abc import Iterator
from pathlib import Path

from imuwb.readers.batch import Batch, CannotSeekError, Limits, Remark
from imuwb.readers.bytes import source
from imuwb.readers.read_options import ReadOptions
from imuwb.readers.text import time_tag
from imuwb.readers.text.cells import blocks
from imuwb.readers.text.encoding import is_text
from imuwb.readers.text.sensor_files import counterparts, is_folder_of_sensors, partners_of
from imuwb.readers.text.several import in_overlapping_blocks, of_folder, of_tags, of_zip, with_partner
from imuwb.readers.text.sidecar import names_of, with_sidecar
from imuwb.readers.text.tables import layouts_of
from imuwb.readers.text.text_table import Table
from imuwb.readers.text.zipped import is_zip_of_text

format = "csv"  # noqa: A001 - the contract's name
uses = ("time_source", "rate", "columns", "units", "frame", "epoch")


def probe(head: bytes) -> bool:
    """Return whether the file begins with text that has digits, in UTF-8 or UTF-16, or is a zip file of texts."""
    return is_zip_of_text(head) or is_text(head)


def probe_folder(folder: Path) -> bool:
    """Return whether a folder has text files of sensors, such as those that a phone app exports."""
    return is_folder_of_sensors(folder)


def beside(name: str) -> tuple[str, ...]:
    """Return the names of the files that may lie beside a log: its sidecar, its time tag, and the file of its other sensor."""
    return *names_of(name), time_tag.name_of(name), *counterparts(name)


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the rows of a text log in pieces.

    Raises:
        UsageError: the columns, units or rate of the file are unknown.
        UnreadableLogError: the file has no row of numbers, or the numbers contradict their stated unit.
    """
    if path.is_dir():
        yield from of_folder(path, options)
        return
    if is_zip_of_text(source.head(path)):
        yield from of_zip(path, options)
        return
    options, remarks = with_sidecar(path, options)
    yield from remarks
    layouts = layouts_of(path, options)
    if layouts[0].tag is None:
        layouts = in_overlapping_blocks(path, layouts[0], options) or layouts
    if layouts[0].tag is not None:
        yield from of_tags(path, layouts, options)
        return
    yield from with_partner(Table(path, layouts[0], options, blocks))


def part(path: Path, options: ReadOptions, limits: Limits) -> Iterator[Batch | Remark]:
    """Yield the first rows of a text log, and those of a part, found by bisection of the file.

    Raises:
        CannotSeekError: the file cannot be searched by time. Other errors are those of ``stream``.
    """
    if path.is_dir() or is_zip_of_text(source.head(path)):
        raise CannotSeekError
    options, remarks = with_sidecar(path, options)
    layouts = layouts_of(path, options)
    if layouts[0].tag is not None or partners_of(path) or in_overlapping_blocks(path, layouts[0], options):
        raise CannotSeekError
    yield from remarks
    yield from Table(path, layouts[0], options, blocks, limits).parts()

"""Several tables of text as one log: the files of a folder or zip file, the tags of a file, and a file with its partner."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

from imuwb.errors import ImuwbError, UnreadableLogError, UsageError
from imuwb.notes import Note
from imuwb.readers.batch import Batch, Remark, unused
from imuwb.readers.bytes import source
from imuwb.readers.read_options import ReadOptions
from imuwb.readers.text.cells import blocks
from imuwb.readers.text.encoding import is_text
from imuwb.readers.text.layout import Layout
from imuwb.readers.text.left_out import UNKNOWN
from imuwb.readers.text.sensor_files import files_in, partners_of
from imuwb.readers.text.sidecar import with_sidecar
from imuwb.readers.text.tables import in_blocks, layouts_of, name_of, tag_counts
from imuwb.readers.text.text_table import Blocks, Table
from imuwb.readers.text.zipped import unpacked
from imuwb.units import SECOND

TOGETHER = 600.0  #: s; files of one record begin within this time
MOST_NAMED = 20  #: number of tags that a note names


def of_zip(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the streams of the text files in a zip file as one log; errors name the zip file."""
    with unpacked(path) as folder:
        try:
            yield from of_folder(folder, options)
        except ImuwbError as error:
            raise type(error)(str(error).replace(str(folder), str(path))) from error


def of_folder(folder: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the streams of the text files in a folder as one log."""
    opened, errors = list[Table](), dict[str, ImuwbError]()
    for file in files_in(folder):
        try:
            if not is_text(source.head(file)):
                continue
            own, remarks = with_sidecar(file, options)
            yield from remarks
            opened += [Table(file, layout, own, blocks) for layout in layouts_of(file, own)]
        except (UsageError, UnreadableLogError) as error:
            errors[file.name] = error
    for part in _together(opened, errors):  # the bytes read of one file are none of the folder's
        yield replace(part, bytes_read=0) if isinstance(part, Batch) else part


def of_tags(path: Path, layouts: Sequence[Layout], options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the streams of the tables of one text file, and name the lines of no table."""
    yield from of_layouts(path, layouts, options, blocks)
    yield from other_rows(tag_counts(path, layouts[0]), layouts)


def in_overlapping_blocks(path: Path, layout: Layout, options: ReadOptions) -> tuple[Layout, ...]:
    """Return the tables of sensors whose rows stand one sensor after the other, although their times overlap; empty: there are none.

    Where the times of the next block go on, the blocks may be runs of one sensor.
    """
    parted = in_blocks(path, layout)
    try:
        tables = [Table(path, one, options, blocks) for one in parted]
    except (UsageError, UnreadableLogError):
        return ()
    if any(later.has_stream and later.start < earlier.end for earlier, later in pairwise(tables)):
        return parted
    return ()


def of_layouts(path: Path, layouts: Sequence[Layout], options: ReadOptions, rows: Blocks) -> Iterator[Batch | Remark]:
    """Yield the streams of the tables of one file."""
    opened, errors = list[Table](), dict[str, ImuwbError]()
    options = replace(options, columns=())  # the layouts have the names
    for layout in layouts:
        try:
            opened.append(Table(path, layout, options, rows))
        except (UsageError, UnreadableLogError) as error:
            errors[name_of(layout)] = error
    yield from _together(opened, errors)


def other_rows(counts: Counter[str], layouts: Sequence[Layout]) -> Iterator[Remark]:
    """Yield a remark on the rows whose tag is that of no table.

    Args:
        counts: the number of rows with each tag.
        layouts: of the tables.
    """
    known = {layout.tag.text for layout in layouts if layout.tag is not None}
    others = [(tag, count) for tag, count in counts.items() if tag and tag not in known]
    if others:
        lines = sum(count for _, count in others)
        yield unused([tag for tag, _ in others[:MOST_NAMED]], f"{lines} lines of no table with numbers")


def _together(opened: Sequence[Table], errors: Mapping[str, ImuwbError]) -> Iterator[Batch | Remark]:
    """Yield the streams of several tables as one log, and name those that are not used.

    Tables of one sensor each belong together; those with the same further words in their names, such as ``Uncalibrated``, are an
    IMU of their own if two tables have the same sensor.
    """
    refused = {name: str(error).partition(": ")[2] for name, error in errors.items()}
    usable = [table for table in opened if table.has_stream]
    if not usable and errors:
        raise next(iter(errors.values()))
    refused |= {table.name: UNKNOWN for table in opened if table not in usable}
    usable, shared = _in_one_frame(usable)
    yield from shared
    several = max(Counter(key for table in usable for key in table.keys).values(), default=1) > 1
    several = several or len({table.record for table in usable if table.record is not None}) > 1
    taken = dict[tuple[str, object], str]()
    for table in sorted(usable, key=lambda table: table.preference) or opened[:1]:
        label = table.label if several else ""
        other = next((taken[label, key] for key in table.keys if (label, key) in taken), None)
        if other is not None:
            refused[table.name] = f"{other} has the same quantities"
            continue
        taken |= dict.fromkeys(((label, key) for key in table.keys), table.name)
        yield from table.parts(label)
    for why in dict.fromkeys(refused.values()):
        yield unused((name for name, reason in refused.items() if reason == why), why)


def with_partner(alone: Table) -> Iterator[Batch | Remark]:
    """Yield the streams of a file, and of the file beside it that has the other sensor of the same record."""
    remarks, other = list[Remark](), None
    for file in partners_of(alone.path) if len(alone.sensors) == 1 else ():
        try:
            own, more = with_sidecar(file, alone.options)
            found = Table(file, layouts_of(file, own)[0], own, blocks)
        except (UsageError, UnreadableLogError) as error:
            remarks.append(_left_out(file, str(error).removeprefix(f"{file}: ")))
            continue
        if len(found.sensors) != 1 or found.sensors == alone.sensors:
            continue
        apart = abs(found.start - alone.start) / SECOND
        if found.epoch != alone.epoch or apart > TOGETHER:
            clocks = f"{found.epoch} time, {alone.epoch} time"
            remarks.append(_left_out(file, f"it begins {apart:.0f} s apart ({clocks})"))
            continue
        text = f"{file.name} beside the log is joined to it, by the name of the file"
        other, remarks = found, [*remarks, Remark(Note("partner", text)), *more]
        break
    tables, shared = _in_one_frame([alone] if other is None else [alone, other])
    yield from tables[0].parts()
    yield from (*remarks, *shared)
    for table in tables[1:]:
        yield from table.parts()


def _left_out(file: Path, why: str) -> Remark:
    return Remark(Note("partner_left_out", f"{file.name} beside the log is not joined: {why}"))


def _in_one_frame(tables: Sequence[Table]) -> tuple[list[Table], list[Remark]]:
    """Return tables of one IMU; if a shape states the frame of some, the others are in that frame too, and a remark says so."""
    inertial = [table for table in tables if table.sensors and table.options.frame is None]
    stated = {table.frame for table in inertial if table.frame}
    unknown = [table for table in inertial if not table.frame]
    if stated != {"FLU"} or not unknown:  # FRD is assumed without a shape
        return list(tables), []
    text = f"{', '.join(table.name for table in unknown)}: its axes are taken as FLU, as those of the other files"
    again = {
        id(table): Table(table.path, table.layout, replace(table.options, frame="FLU"), table.blocks)
        for table in unknown
    }
    return [again.get(id(table), table) for table in tables], [Remark(Note("frame_shared", text))]

"""Text files that hold several tables: the rows of each begin with a tag, or have it in a column of their own.

``ACCE;12.5;0.1;0.2;9.8;3`` and ``GYRO;12.5;...``, ``$VNIMU,...*5F``, ``UncalAccel,...``: the rows of each tag are a table with a header
of its own, and are read as a file of their own.
"""

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

from imuwb.errors import UnreadableLogError
from imuwb.readers.bytes import source
from imuwb.readers.read_options import ReadOptions
from imuwb.readers.text.encoding import encoding_of, plain
from imuwb.readers.text.keyed_lines import tables_of_keys
from imuwb.readers.text.layout import Layout, Tag, cells_of, head_lines, is_numeric, layout_of
from imuwb.readers.text.sensor_files import lone_axes, named_axes, stem
from imuwb.readers.text.shapes.application import shape_of_log
from imuwb.readers.text.trust import is_number

TAGGED = 0.6  #: least share of the lines of a tagged file that have a tag and numbers
MOST = 64  #: number of tags; more different texts are values, not tags
REPEATED = 3  #: rows that a tag has on average, at least
_TAG = re.compile(r"[$#%!@]?[A-Za-z_][\w/.\-]{0,40}")
_LETTERED = re.compile(
    r"\s*(?:[^A-Za-z,;\t]*[,;\t ]\s*)?[\"$#%!@]?[A-Za-z_]"
)  #: a line with a letter early in its first two cells
_CHECKSUM = re.compile(r"\*[0-9A-Fa-f]{2}$")
#: names of a column that tells the rows of several sensors apart, letters only
_TAG_NAME = re.compile(
    r"(?:sensor|device|dev|imu|node|unit|module|board|instance|frame|channel|mac|serial|body|bodypart|segment|location|placement|side)"
    r"(?:id|name|type|no|nr|num|number|index|idx|address)?"
    r"|i|id|name|type|tag|message|msg|msgtype|topic|ch|address|addr|sn|port|source|src"
)
TURNS = 0.9  #: least share of the rows that have the same text as the row before of the same sensor, where sensors take turns
_STATES = {
    "true",
    "false",
    "yes",
    "no",
    "on",
    "off",
    "ok",
    "valid",
    "invalid",
    "good",
    "bad",
    "high",
    "low",
    "a",
    "v",
    "t",
    "f",
    "y",
    "n",
}


def layouts_of(path: Path, options: ReadOptions) -> tuple[Layout, ...]:
    """Return the layout of a file of one table, or a layout for each tag of a file of several.

    Raises:
        UnreadableLogError: the file's first lines have no row of numbers.
    """
    lines = head_lines(path)
    bare = Layout(",", 0, (), (), encoding=encoding_of(source.head(path)), fault=source.packed_fault(path))
    try:
        layout = layout_of(path)
    except UnreadableLogError:
        tables = tuple(tables_of_keys(lines, bare)) or tuple(_by_first_cells(lines, bare))
        if not tables:
            raise
        return tables
    if options.columns:
        fits = len(options.columns) == len(layout.first)
        return (tuple(by_column(replace(layout, names=options.columns))) if fits else ()) or (layout,)
    whole = lone_axes(named_axes(layout, stem(path)))
    shape = shape_of_log(path, whole, options)
    if shape is not None and any(column.quantity == "instance" for column in shape.columns):
        return (whole,)
    return tuple(_by_first_cells(lines, layout)) or tuple(by_column(layout)) or (whole,)


def name_of(table: Layout) -> str:
    """Return the name of a table: its tag without a mark."""
    return "" if table.tag is None else table.tag.text.lstrip("$#%!@")


def _by_first_cells(lines: Sequence[str], layout: Layout) -> Iterator[Layout]:
    """Yield the tables of a file whose rows have a tag in one of the first two cells."""
    filled = [line for line in lines if line.strip()]
    if sum(_LETTERED.match(line) is not None for line in filled) < TAGGED * len(filled):
        return  # nearly all files
    for delimiter, place in ((d, p) for p in (0, 1) for d in (",", ";", "\t", " ")):
        rows = [(cells, line) for line in filled if _has_tag(cells := cells_of(line, delimiter), place)]
        tags = list(dict.fromkeys(cells[place] for cells, _ in rows))
        if len(rows) < TAGGED * len(filled) or not 0 < len(tags) <= min(MOST, max(1, len(rows) // REPEATED)):
            continue
        others = [line for line in filled if not _has_tag(cells_of(line, delimiter), place)]
        sizes = {tag: {len(cells) for cells, _ in rows if cells[place] == tag} for tag in tags}
        marked = all(tag[0] in "$#%!@" for tag in tags)
        named = layout.names[place] if len(layout.names) > place else ""
        one_header = bool(named) and named not in tags and len({max(s) for s in sizes.values()}) == 1
        if (len(tags) < 2 and not marked) or (one_header and not marked and not _is_tag_name(named)):  # noqa: PLR2004
            return
        for tag in tags:
            yield _table(tag, place, delimiter, [cells for cells, _ in rows if cells[place] == tag], others, layout)
        return


def _has_tag(cells: list[str], place: int) -> bool:
    """Return whether a line has a tag at a place, a number or nothing before it, and numbers after it."""
    if len(cells) < place + 2 or not _TAG.fullmatch(cells[place]):
        return False
    rest = [_CHECKSUM.sub("", cell) for cell in cells[place + 1 :]]
    return is_numeric(rest) and all(map(is_number, cells[:place]))


def _table(
    tag: str, place: int, delimiter: str, rows: list[list[str]], others: Sequence[str], layout: Layout
) -> Layout:
    """Return the layout of the rows of one tag."""
    usual = max(set(sizes := [len(cells) for cells in rows]), key=sizes.count)
    whole = [cells for cells in rows if len(cells) == usual]
    checked = 2 * sum(bool(_CHECKSUM.search(cells[-1])) for cells in whole) > len(whole)
    sample = tuple((*cells[:-1], _CHECKSUM.sub("", cells[-1])) for cells in whole)
    names = _own_names(tag, place, delimiter, usual, others) or (
        layout.names if len(layout.names) == usual and layout.delimiter == delimiter else ()
    )
    table = Layout(
        delimiter, 0, names, sample[0], decimal="." if delimiter == "," else layout.decimal, sample=sample, comments=tuple(others),
        encoding=layout.encoding, fault=layout.fault, tag=Tag(place, tag, checked=checked),
    )  # fmt: skip
    return named_axes(table, tag)


def _own_names(tag: str, place: int, delimiter: str, usual: int, others: Sequence[str]) -> tuple[str, ...]:
    """Return the names that a line states for the rows of a tag: the tag, then a name for each cell, and perhaps a line of units."""
    stated = list[list[str]]()
    start = re.compile(rf"(?<![\w$]){re.escape(tag.lstrip('$#%!@'))}\s*{re.escape(delimiter)}")
    for line in others:
        match = start.search(line)
        cells = cells_of(line[match.start() :].rstrip().rstrip("'\""), delimiter) if match else []
        if len(cells) == usual - place and not is_numeric(cells[1:]):
            stated.append(cells[1:])
    if not stated:
        return ()
    units = stated[1] if len(stated) > 1 else [""] * len(stated[0])
    names = (f"{name} [{measure}]" if measure else name for name, measure in zip(stated[0], units, strict=True))
    return (*["time"] * place, "-", *names)


def by_column(layout: Layout) -> Iterator[Layout]:
    """Yield the tables of a file with a column whose name and values tell sensors apart."""
    for place, name in enumerate(layout.names):
        cells = layout.cells(place)
        values = list(dict.fromkeys(cells))
        few = 1 < len(values) <= min(MOST, len(cells) // REPEATED)
        if (
            not few
            or not all(map(_is_value, values))
            or not ((_is_tag_name(name) and _recur(cells)) or _take_turns(cells))
        ):
            continue
        for value in values:
            sample = tuple(row for row in layout.sample if row[place] == value)
            names = tuple("-" if i == place else other for i, other in enumerate(layout.names))
            table = replace(layout, names=names, sample=sample, first=sample[0], tag=Tag(place, value))
            yield named_axes(table, value)
        return


def in_blocks(path: Path, layout: Layout) -> tuple[Layout, ...]:
    """Return the tables of a file in which the rows of each sensor stand together, by a column named after sensors; empty: there are none.

    The first rows may be those of one sensor alone, so the whole file is looked at, if it has such a column.
    """
    for place, name in enumerate(layout.names):
        if not _is_tag_name(name):
            continue
        cells = layout.cells(place)
        kinds = set(cells)
        if not all(map(_is_value, kinds)) or len(kinds) * REPEATED > len(cells):
            continue
        counts = tag_counts(path, replace(layout, tag=Tag(place, "")))
        values = [value for value, count in counts.items() if count >= REPEATED and _is_value(value)]
        if 1 < len(values) <= MOST:
            names = tuple("-" if i == place else other for i, other in enumerate(layout.names))
            return tuple(named_axes(replace(layout, names=names, tag=Tag(place, value)), value) for value in values)
    return ()


def _is_tag_name(name: str) -> bool:
    """Return whether a name, or its last part (``header.frame_id``), is one of a column that tells sensors apart."""
    low = name.lower()
    return any(_TAG_NAME.fullmatch(re.sub(r"[^a-z]", "", part)) for part in (low, re.split(r"[./]", low)[-1]))


def _is_value(value: str) -> bool:
    """Return whether a cell may name a sensor: a whole number, or a text such as a word, a number of a series or an address."""
    return value.isdigit() or (not is_number(value) and re.fullmatch(r"[$#]?\w[\w/.:\- ]{0,40}", value) is not None)


def _recur(cells: Sequence[str]) -> bool:
    """Return whether values come again after others; those of a counter, such as the frame of a video, do not."""
    return 1 + sum(a != b for a, b in pairwise(cells)) >= 2 * len(set(cells))


def _take_turns(cells: Sequence[str]) -> bool:
    """Return whether words follow each other as the names of sensors do that take turns; a state changes now and then."""
    kinds = len(set(cells))
    words = (
        all(re.match(r"[$#]?[A-Za-z_]", cell) for cell in set(cells)) and not {cell.lower() for cell in cells} & _STATES
    )
    again = sum(a == b for a, b in zip(cells, cells[kinds:], strict=False))
    changes = sum(a != b for a, b in pairwise(cells))
    return words and min(again, changes) >= TURNS * (len(cells) - kinds)


def tag_counts(path: Path, layout: Layout) -> Counter[str]:
    """Return how many lines of a whole file have each text in the place of a table's tag."""
    counts = Counter[bytes]()
    place = layout.tag.column if layout.tag is not None else 0
    keyed = layout.tag is not None and layout.tag.keyed
    mark = rb"[ \t]+" if layout.delimiter == " " else re.escape(layout.delimiter.encode())
    cell = rb"[^ \t\n]*" if layout.delimiter == " " else rb"[^" + mark + rb"\n]*"
    cells = rb"(?:" + cell + mark + rb"){" + str(place).encode() + rb"}[ \t]*(" + cell + rb")"
    pattern = re.compile(rb"(?m)^[^\n{]*: (\w+) \{" if keyed else rb"(?m)^[ \t]*" + cells)
    with source.open_unpacked(path) as file:
        for block, _ in source.lines(plain(source.pieces(file, []), layout.encoding)):
            counts.update(pattern.findall(block))
    counts.subtract(pattern.findall("\n".join(head_lines(path)[: layout.skip]).encode()))  # a header is no row
    return Counter({tag.decode("utf-8", "replace").strip().strip('"'): n for tag, n in counts.items() if n > 0})

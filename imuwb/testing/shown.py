"""What a plugin draws, looked at: it is drawn into a recording, every number has its unit, and words of a log do nothing."""

import re
import tempfile
import unicodedata
from collections.abc import Callable, Iterator
from pathlib import Path

from imuwb.analysis import Bars, Figure, Review, Series, Table
from imuwb.log import Log
from imuwb.review.drawn.calls import Item
from imuwb.review.recording.review import RecordingReview
from imuwb.review.recording.rrd_chunks import chunks
from imuwb.review.scene.clock import Clock
from imuwb.texts import printable

TEXT = "TextDocument:text"  #: end of the name of a component
NUMBER = re.compile(r"[-+−]?\d+\.\d+([eE][-+]?\d+)?|[-+−]?\d+[eE][-+]?\d+")  #: a whole number is a count
UNIT = re.compile(r"[\[(].*[\])]")
#: what may make a viewer load or open something
LINKS = re.compile(r"(?<!\\)\]\(|(?<!\\)!\[|(?<!\\)<(http|img|script)")
BLOCK = re.compile(r"(?ms)^(`{3,})[a-z]*\n.*?^\1$")  #: lines that Markdown shows as they are
HIDDEN = {"Cc", "Cf", "Zl", "Zp"}


def drawn(log: Log, draw: Callable[[Review], None]) -> tuple[tuple[Item, ...], tuple[str, ...]]:
    """Return the calls of a drawing, and the faults of the texts in the recording that it makes.

    Raises:
        Exception: what the drawing raises; ValueError: it draws what no chart can show.
    """
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "check.rrd"
        review = RecordingReview(file, clock=Clock.of([log]))
        try:
            draw(review)
            review.close()
        except BaseException:
            review.discard()
            raise
        return tuple(one.item for one in review.drawn), tuple(_texts(file))


def _texts(file: Path) -> Iterator[str]:
    """Yield the faults of entity paths and texts of a recording."""
    for entity, batch in chunks(file, ("/",)):
        if printable(entity) != entity:
            yield f"the entity path {printable(entity)!r} has letters that are not shown; make it of imuwb.texts.printable"
        for name, column in zip(batch.schema.names, batch.columns, strict=True):
            if not name.endswith(TEXT):
                continue
            for text in (text for cell in column.to_pylist() for text in cell or ()):
                if hidden := {c for c in text if unicodedata.category(c) in HIDDEN and c not in "\n\t"}:
                    yield f"a text of {entity} has the hidden letters {sorted(hidden)!r}; pass words of a log through imuwb.texts.printable"
                if found := LINKS.search(BLOCK.sub("", text)):
                    yield f"words of a log become Markdown in {entity} ({found[0]!r}); pass them through imuwb.texts.markdown_text"


def unit_faults(items: tuple[Item, ...]) -> Iterator[str]:
    """Yield what is drawn without its unit."""
    for item in items:
        if isinstance(item, Figure):
            for title in (item.x_title, item.y_title):
                if not UNIT.search(title):
                    yield f"the axis {title!r} of the figure {item.title!r} has no unit; write it in brackets: 'lag [s]', 'ratio [1]'"
        elif isinstance(item, Series | Bars):
            if not item.unit:
                yield f"{type(item).__name__} {item.title!r} has no unit; give its unit, or '1'"
        elif isinstance(item, Table):
            yield from _table_faults(item)


def _table_faults(table: Table) -> Iterator[str]:
    for column, heading in enumerate(table.headings):
        cells = [row[column] for row in table.rows if column < len(row)]
        bare = next((cell for cell in cells if NUMBER.fullmatch(cell.strip())), None)
        if bare is not None and not UNIT.search(heading):
            yield f"the number {bare} below {heading!r} of the table {table.title!r} has no unit; write it in the cell or in the heading"

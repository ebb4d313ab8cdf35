"""The page of a folder of recordings: a row for each, with its verdict, its figures, and links to it and to its page."""

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import cast
from urllib.parse import quote

from jinja2 import Environment, StrictUndefined

from imuwb.errors import MissingDataError, UnreadableLogError
from imuwb.review.recording.recorded import Recorded, Value, read
from imuwb.texts import printable

#: properties that have a column of their own, or none; all others are figures of the answer
COLUMNS = ("analysis", "log", "sensor", "headline", "verdict")
DETAILS = ("about", "level", "hash", "imuwb", "run")
FOREIGN = "not a result of imuwb, or of a version that stated none: only the viewer shows what it contains"


@dataclass(frozen=True, slots=True)
class Entry:
    """A row of the catalog; texts can be shown."""

    file: str
    link: str  #: to the recording, relative to the page
    page: str  #: link to the page beside the recording; empty: there is none
    name: str
    cells: tuple[str, ...]  #: under ``COLUMNS``
    figures: tuple[tuple[str, str], ...]  #: name and value
    details: tuple[tuple[str, str], ...]
    remark: str = ""  #: why the row says no more


def entries(folder: Path, output: Path, progress: Callable[[int, int], None] | None = None) -> tuple[Entry, ...]:
    """Return a row for each recording in a folder, not in the folders below it.

    Args:
        folder: of the recordings.
        output: the page, to which links are relative.
        progress: called with (recordings read, recordings).

    Raises:
        UnreadableLogError: the folder cannot be read.
        MissingDataError: it has no recording.
    """
    try:
        files = sorted(path for path in folder.iterdir() if path.suffix == ".rrd" and not path.name.startswith("."))
    except OSError as error:
        raise UnreadableLogError(f"{folder}: {error.strerror or error}; give a folder of recordings") from error
    if not files:
        raise MissingDataError(
            f"{folder}: no recording (*.rrd) is in this folder; imuwb analyses write them, and -o places them"
        )
    rows: list[Entry] = []
    for file in files:
        rows.append(_entry(file, output.parent))
        if progress is not None:
            progress(len(rows), len(files))
    return tuple(rows)


def _entry(file: Path, home: Path) -> Entry:
    beside = file.with_suffix(".html")
    file_name, link, page = printable(file.name), _link(file, home), _link(beside, home) if beside.is_file() else ""
    try:
        recorded = read(file)
    except UnreadableLogError as error:
        return Entry(file_name, link, page, "", (), (), (), printable(str(error).removeprefix(f"{file}: ")))
    name = printable(recorded.name)
    if recorded.foreign:
        return Entry(file_name, link, page, name, (), (), (), FOREIGN)
    return Entry(file_name, link, page, name, _texts(recorded, COLUMNS), _figures(recorded), _named(recorded))


def _link(file: Path, home: Path) -> str:
    """Return the address of a file, relative to a folder if both are on one drive; no name can be the name of a scheme."""
    try:
        relative = Path(os.path.relpath(file, home)).as_posix()
    except ValueError:  # another drive
        return file.resolve().as_uri()
    return f"./{quote(os.fsencode(relative))}"


def _texts(recorded: Recorded, names: Sequence[str]) -> tuple[str, ...]:
    return tuple(_text(recorded.properties.get(name, "")) for name in names)


def _named(recorded: Recorded) -> tuple[tuple[str, str], ...]:
    return tuple((name, text) for name, text in zip(DETAILS, _texts(recorded, DETAILS), strict=True) if text)


def _figures(recorded: Recorded) -> tuple[tuple[str, str], ...]:
    """Return the figures of the answer, each with its interval after its value."""
    texts = {name: _text(value) for name, value in recorded.properties.items() if name not in {*COLUMNS, *DETAILS}}
    intervals = {name.replace(" interval", "", 1): name for name in texts if " interval" in name}
    joined = {name: " ".join(filter(None, (text, texts.get(intervals.get(name, ""))))) for name, text in texts.items()}
    return tuple((printable(name), joined[name]) for name in sorted(joined.keys() - set(intervals.values())))


def _text(value: Value) -> str:
    """Return a value as a text; a list of two numbers is an interval."""
    if isinstance(value, str):
        return printable(value)
    if isinstance(value, int | float):
        return f"{value:.6g}"
    parts = [_text(item) for item in cast("Sequence[Value]", value)]
    numbers = all(not isinstance(item, str) for item in value)
    return f"[{', '.join(parts)}]" if numbers else ", ".join(dict.fromkeys(parts))


def catalog(folder: Path, rows: Sequence[Entry], version: str) -> str:
    """Return the HTML of a catalog: one file that asks for no other, whose columns can be sorted."""
    home = resources.files("imuwb.review.page")
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    template = environment.from_string(home.joinpath("catalog.html.jinja").read_text("utf-8"))
    return template.render(
        folder=printable(folder.resolve().name or str(folder)), rows=rows, columns=COLUMNS, version=version,
        sheet=home.joinpath("page.css").read_text("utf-8"), script=home.joinpath("page.js").read_text("utf-8"),
    )  # fmt: skip

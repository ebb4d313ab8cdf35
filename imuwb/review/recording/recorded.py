"""What a recording contains besides its tabs: its name, its properties, and texts such as the JSON of the result.

The viewer shows name and properties; a catalog of recordings has a column for each property. A text is kept compressed (xz).
"""

import json
import lzma
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias, cast

import numpy as np
import rerun as rr

from imuwb.errors import UnreadableLogError
from imuwb.readers.bytes import budget
from imuwb.readers.bytes.budget import Budget, under
from imuwb.renames import settle
from imuwb.review.recording.rrd import is_whole
from imuwb.review.recording.rrd_chunks import FAULTS, chunks

Value: TypeAlias = str | int | float | Sequence[str] | Sequence[float]

PROPERTIES = "imuwb"  #: name of the group of properties
DOCUMENT = "document"  #: name of the text that is the JSON of the result
_PROPERTIES, _KEPT = f"/__properties/{PROPERTIES}", "/imuwb/"  # entity paths
_NAME, _TEXT = "RecordingInfo:name", "text_xz"  # components
DIGITS = 7  #: significant digits of a number in a kept JSON
LONG = 16  #: a longer list is a curve
DIGITS_OF_CURVES = 5  #: significant digits of its numbers
DICTIONARY = 128 << 20  #: bytes that the unpacking of a text may always take
LARGE = 1e6  #: a larger number keeps all digits: it may be a time since 1970


@dataclass(frozen=True, slots=True)
class Recorded:
    """What a recording contains besides its tabs."""

    path: Path
    name: str  #: empty: the recording has none
    properties: Mapping[str, Value]  #: those of imuwb; empty: another program made the recording
    texts: Mapping[str, str]  #: kept texts

    @property
    def foreign(self) -> bool:
        """Whether the recording is not one of imuwb that states what it contains."""
        return not self.properties

    def document(self) -> dict[str, Any] | None:
        """Return the JSON of the result; None if the recording has none; UnreadableLogError if it is damaged."""
        if DOCUMENT not in self.texts:
            return None
        try:
            found: object = json.loads(self.texts[DOCUMENT])
        except (ValueError, RecursionError) as error:
            raise UnreadableLogError(f"{self.path}: the JSON of its result is damaged: {error}") from error
        if not isinstance(found, dict):
            raise UnreadableLogError(f"{self.path}: the JSON of its result is no object")
        return cast("dict[str, Any]", found)


def state(recording: rr.RecordingStream, name: str, properties: Mapping[str, Value]) -> None:
    """Write the name and the properties of a recording; numbers stay numbers."""
    recording.send_recording_name(name)
    recording.send_property(PROPERTIES, rr.AnyValues(drop_untyped_nones=True, **dict(properties)))


def keep(recording: rr.RecordingStream, name: str, text: str) -> None:
    """Keep a text in a recording; its name has letters only."""
    packed = np.frombuffer(lzma.compress(text.encode("utf-8", "replace"), preset=9), np.uint8)
    recording.log(f"{_KEPT}{name}", rr.AnyValues(drop_untyped_nones=True, **{_TEXT: packed}), static=True)


def compact(text: str) -> str:
    """Return a JSON text without blanks: numbers have seven significant digits, those of curves five, large numbers all."""
    return json.dumps(_rounded(json.loads(text)), ensure_ascii=False, separators=(",", ":"))


def _rounded(value: object, digits: int = DIGITS) -> object:
    if isinstance(value, float) and math.isfinite(value) and abs(value) < LARGE:
        return float(f"{value:.{digits}g}")
    if isinstance(value, list):
        items = cast("list[object]", value)
        return [_rounded(item, DIGITS_OF_CURVES if len(items) > LONG else digits) for item in items]
    if isinstance(value, dict):
        return {key: _rounded(item, digits) for key, item in cast("dict[str, object]", value).items()}
    return value


def read(path: str | Path) -> Recorded:
    """Read what a recording contains besides its tabs.

    Raises:
        UnreadableLogError: the file is no recording, or it is cut or damaged.
    """
    path = Path(path)
    settle(path)
    try:
        if not is_whole(path):
            raise UnreadableLogError(f"{path}: no whole recording: the mark at its begin or at its end is missing")
        parts = under(Budget(str(path), path.stat().st_size), lambda: list(_parts(path)))
    except FAULTS as error:
        why = (getattr(error, "strerror", None) or str(error) or type(error).__name__).splitlines()[0][:160]
        raise UnreadableLogError(f"{path}: the recording cannot be read, or is damaged: {why}") from error
    names = [value for _, component, value in parts if component == _NAME and isinstance(value, str)]
    properties = {component: value for entity, component, value in parts if entity == _PROPERTIES}
    texts = {
        entity.removeprefix(_KEPT): str(value)
        for entity, component, value in parts
        if entity.startswith(_KEPT) and component == _TEXT
    }
    return Recorded(path, names[0] if names else "", properties, texts)


def _parts(path: Path) -> Iterator[tuple[str, str, Any]]:
    """Yield entity, component and value of each property and each kept text."""
    held = 0
    for entity, batch in chunks(path, ("/__properties", _KEPT)):
        for name, cells in zip(batch.schema.names, batch.columns, strict=True):
            if entity.startswith(_KEPT) and name == _TEXT and batch.num_rows:
                text = _unpacked(cells)
                held += len(text)
                budget.check(held, "its texts")
                yield entity, name, text
                continue
            value = cells[0].as_py() if batch.num_rows else None
            if isinstance(value, list) and value:
                items = cast("list[Any]", value)
                yield entity, name, items[0] if len(items) == 1 else items


def _unpacked(cells: Any) -> str:  # noqa: ANN401 - of a library without types
    """Return the text that the first row of a column keeps."""
    most = budget.current().most
    packed = cells[0].values.to_numpy(zero_copy_only=False).astype(np.uint8).tobytes()
    unpacker = lzma.LZMADecompressor(memlimit=max(most, DICTIONARY))
    try:
        text = unpacker.decompress(packed, most + 1)
    except lzma.LZMAError as error:
        raise ValueError(f"a text in it cannot be unpacked: {error}") from error
    budget.check(len(text), "a text in it")
    if not unpacker.eof:
        raise ValueError("a text in it is cut")
    return text.decode()

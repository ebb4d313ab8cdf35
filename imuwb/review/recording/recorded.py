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
from rerun.chunk import Chunk, RrdReader

from imuwb.errors import UnreadableLogError
from imuwb.renames import settle
from imuwb.review.recording.rrd import is_whole

Value: TypeAlias = str | int | float | Sequence[str] | Sequence[float]

PROPERTIES = "imuwb"  #: name of the group of properties
DOCUMENT = "document"  #: name of the text that is the JSON of the result
_PROPERTIES, _KEPT = f"/__properties/{PROPERTIES}", "/imuwb/"  # entity paths
_NAME, _TEXT = "RecordingInfo:name", "text_xz"  # components
DIGITS = 7  #: significant digits of a number in a kept JSON
LONG = 16  #: a longer list is a curve
DIGITS_OF_CURVES = 5  #: significant digits of its numbers
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
        """Return the JSON of the result; None if the recording has none."""
        return json.loads(self.texts[DOCUMENT]) if DOCUMENT in self.texts else None


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
        chunks = RrdReader(path).store().stream().filter(content=["+ /__properties/**", f"+ {_KEPT}**"]).to_chunks()
        parts = [(str(chunk.entity_path), name, value) for chunk in chunks for name, value in _cells(chunk)]
    except OSError as error:
        raise UnreadableLogError(f"{path}: cannot be read: {error.strerror or error}") from error
    except (RuntimeError, ValueError) as error:  # those of the viewer's library
        why = str(error).partition(f"{path}: ")[2] or str(error)
        raise UnreadableLogError(f"{path}: the recording is damaged: {why}") from error
    names = [value for _, component, value in parts if component == _NAME and isinstance(value, str)]
    properties = {component: value for entity, component, value in parts if entity == _PROPERTIES}
    texts = {
        entity.removeprefix(_KEPT): _unpacked(path, value)
        for entity, component, value in parts
        if entity.startswith(_KEPT) and component == _TEXT
    }
    return Recorded(path, names[0] if names else "", properties, texts)


def _cells(chunk: Chunk) -> Iterator[tuple[str, Any]]:
    """Yield the components of the first row of a chunk, a single value without its list."""
    batch = chunk.to_record_batch()
    for name in batch.schema.names:
        value = batch.column(name)[0].as_py() if batch.num_rows else None
        if isinstance(value, list) and value:
            items = cast("list[Any]", value)
            yield name, items[0] if len(items) == 1 else items


def _unpacked(path: Path, packed: object) -> str:
    try:
        return lzma.decompress(bytes(cast("list[int]", packed))).decode()
    except (lzma.LZMAError, TypeError, ValueError) as error:
        raise UnreadableLogError(f"{path}: the recording is damaged: a text in it cannot be unpacked") from error

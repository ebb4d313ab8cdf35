"""What is known of sentences: lines of text that begin with a tag, such as ``$VNIMU`` or ``#RAWIMUSXA``."""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property
from importlib.resources import files
from typing import Any

from imuwb.readers.text.shapes.shape import Shape, shape_from
from imuwb.readers.text.trust import is_number

TABLE = "sentences.toml"
DESCRIBED = "$COL"  #: tag of the sentence with which a file names the cells of another one
#: keys of a sentence that a shape does not have
_OWN = ("tags", "only", "stream", "device", "scale")


@dataclass(frozen=True)
class Sentence:
    """The cells of one kind of sentence; the table's first lines say what each part means."""

    shape: Shape
    tags: tuple[str, ...]
    only: Mapping[int, str] = field(default_factory=dict[int, str])
    stream: str = ""
    device: int = -1  #: cell with the type of the IMU; -1: there is none
    scale: str = ""  #: name of the table of scales by type; empty: the numbers have units

    @cached_property
    def needed(self) -> int:
        """Number of cells up to the last one that has a meaning."""
        return max(cell for cell, meaning in enumerate(self.shape.row) if meaning is not None) + 1

    @property
    def is_imu(self) -> bool:
        """Whether the cells are of an IMU."""
        imu = ("gyro", "accel", "attitude_increment", "velocity_increment")
        return any(meaning is not None and meaning.quantity in imu for meaning in self.shape.row)

    def fits(self, cells: Sequence[str]) -> bool:
        """Return whether a line with the tag has the cells that the sentence has: their number, and the ranges of some."""
        if len(cells) < self.needed or (self.shape.cells and len(cells) != self.shape.cells):
            return False
        return all(
            is_number(cells[cell]) and low <= float(cells[cell]) <= high
            for cell, (low, high) in self.shape.ranges.items()
        )


@dataclass(frozen=True, slots=True)
class Sentences:
    """All known sentences by tag, why some are refused, and the scales of NovAtel's IMUs by type."""

    by_tag: Mapping[str, Sentence]
    refused: Mapping[str, str]
    increments: Mapping[int, tuple[float, float]]  #: rad and m/s for each count
    rates: Mapping[int, tuple[float, float]]  #: deg/s and mg for each count


@cache
def sentences() -> Sentences:
    """Return all known sentences."""
    table = files("imuwb.readers.text.shapes").joinpath(TABLE)
    document = tomllib.loads(table.read_text("utf-8"))
    known = [_sentence(stated) for stated in document["sentence"]]
    scales = {
        kind: {int(number): (gyro, accel) for number, (gyro, accel) in document["novatel"][kind].items()}
        for kind in ("increments", "rates")
    }
    return Sentences(
        {tag: sentence for sentence in known for tag in sentence.tags},
        {tag: stated["why"] for stated in document["refused"] for tag in stated["tags"]},
        scales["increments"],
        scales["rates"],
    )


def _sentence(stated: Mapping[str, Any]) -> Sentence:
    shape = shape_from({key: value for key, value in stated.items() if key not in _OWN})
    own = {key: value for key, value in stated.items() if key in _OWN and key not in ("tags", "only")}
    only = {int(cell): text for cell, text in stated.get("only", {}).items()}
    return Sentence(shape, tuple(stated["tags"]), only=only, **own)

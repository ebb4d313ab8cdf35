"""Recognises the quantities of a message by the names of its fields, in any encoding.

``sensor_msgs/Imu``, a private protobuf and a JSON object all have ``angular_velocity.x``; if another message contains
one of these, the name has a prefix. A shape states which fields make which column; ``known_shapes`` lists the shapes.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from imuwb.arrays import Floats, Integers
from imuwb.geodesy import swapped_axes
from imuwb.log import SECOND, Kind
from imuwb.readers.batch import Batch
from imuwb.readers.containers.message_columns import Quantity, path_of

LATEST = 9.2e9  #: s; later nanoseconds do not fit into int64
MICROSECOND = 1000  #: ns
NO_OFFSET = 2**31 - 1  #: of a sample of PX4 that has no time
FIRST_NUMBER = -1  #: length of an array of which only the first number is used


@dataclass(frozen=True, slots=True)
class Stamp:
    """The fields of a message's own time."""

    fields: tuple[str, ...]
    units: tuple[int, ...]  #: ns of each; the time is the sum
    instead: bool = False  #: whether the second field counts where the first is 0, and is not added to it
    around: bool = False  #: whether it may be in a message that contains the measurement


@dataclass(frozen=True, slots=True)
class Shape:
    """Which fields make a stream."""

    kind: Kind
    key: str  #: a field that it needs; what comes before it in a path is the prefix
    quantities: tuple[Quantity, ...]
    units: str = ""  #: of the messages
    frame: str = ""  #: of the messages
    body: str = "FLU"  #: body axes of an IMU unless the user states others
    stamps: tuple[Stamp, ...] = ()  #: beside those of a header
    allowed: Callable[[str, str], bool] = lambda _schema, _topic: True  #: what schema and topic must be
    part: str = ""  #: end of the stream's name where a message has several of a kind
    gravity: bool = False  #: whether only gravity in its first messages shows that these are specific forces
    refused: str = ""  #: why messages of this shape are not used

    @property
    def heights(self) -> tuple[str, ...]:
        """The fields of heights, of which a message need have none."""
        return next((quantity.optional for quantity in self.quantities if quantity.column == "position"), ())


@dataclass(frozen=True, slots=True)
class Recipe:
    """How the messages of one channel become a stream."""

    shape: Shape
    prefix: str  #: path of the measurement in the message; empty for the whole message
    stamp: Stamp | None
    quantities: tuple[Quantity, ...]  #: those whose fields the messages have
    paths: tuple[str, ...]  #: paths of all fields that are needed

    @property
    def kind(self) -> Kind:
        """The kind of the stream."""
        return self.shape.kind

    @property
    def lacks_height(self) -> bool:
        """Whether the messages have positions without a height."""
        heights = self.shape.heights
        return bool(heights) and not any(self.prefix + name in self.paths for name in heights)

    def columns(self, values: Mapping[str, Floats], frame: str | None) -> dict[str, Floats]:
        """Return the columns of the stream.

        Args:
            values: {path: numbers}.
            frame: body axes that the user states.
        """
        begin, body = len(self.prefix), frame or self.shape.body
        own = {path[begin:]: numbers for path, numbers in values.items() if path.startswith(self.prefix)}
        made = {quantity.column: quantity.convert(own, body) for quantity in self.quantities}
        return {column: numbers for column, numbers in made.items() if numbers is not None}


_SECONDS = (
    ("header.stamp.sec", "header.stamp.nanosec"), ("header.stamp.secs", "header.stamp.nsecs"),
    ("stamp.sec", "stamp.nanosec"), ("timestamp.sec", "timestamp.nsec"), ("timestamp.sec", "timestamp.nanosec"),
    ("timestamp.seconds", "timestamp.nanos"),
)  # fmt: skip
#: stamps of a header, or of a message
HEADERS = tuple(Stamp(fields, (SECOND, 1), around=True) for fields in _SECONDS)


def recognised(
    known: Mapping[str, int], schema: str, topic: str, shapes: tuple[tuple[Shape, ...], ...]
) -> tuple[Recipe, ...]:
    """Return the recipes for a topic's messages: none, one or several.

    Args:
        known: {path of a field: length of its array, 0 for a number}.
        schema: name of the messages' type.
        topic: their topic.
        shapes: groups of shapes; where a group has a shape of a prefix, or uses a key, later groups are not asked for it.
    """
    recipes: list[Recipe] = []
    fields = tuple(known.items())
    for group in shapes:
        found: list[Recipe] = []
        taken = {recipe.prefix for recipe in recipes}
        used = {path for recipe in recipes for path in (*recipe.paths, recipe.prefix + path_of(recipe.shape.key))}
        for path, recipe in _candidates(fields, group):
            if path not in used and recipe.prefix not in taken and recipe.shape.allowed(schema, topic):
                found.append(recipe)
        recipes += found
    return tuple(recipes)


@lru_cache(maxsize=64)  # the topics of a log often have one type, and a log may have thousands of topics
def _candidates(fields: tuple[tuple[str, int], ...], group: tuple[Shape, ...]) -> tuple[tuple[str, Recipe], ...]:
    """Return the recipes that the fields of a message allow, each with the path of its key."""
    known, found = dict(fields), list[tuple[str, Recipe]]()
    for path in known:
        for shape in group:
            key = path_of(shape.key)
            if path == key or path.endswith(f".{key}"):
                recipe = _recipe(shape, path[: -len(key)], known)
                if recipe is not None:
                    found.append((path, recipe))
    return tuple(found)


def _recipe(shape: Shape, prefix: str, known: Mapping[str, int]) -> Recipe | None:
    def has(fields: tuple[str, ...]) -> bool:
        return all(_has(known, prefix, field) for field in fields)

    if not _has(known, prefix, shape.key) or not all(has(q.fields) for q in shape.quantities if q.needed):
        return None
    quantities = tuple(quantity for quantity in shape.quantities if has(quantity.fields))
    stamp = _stamp(shape, known, prefix)
    names = [field for q in quantities for field in (*q.fields, *(o for o in q.optional if _has(known, prefix, o)))]
    paths = (*(stamp.fields if stamp is not None else ()), *(prefix + path_of(name) for name in names))
    return Recipe(shape, prefix, stamp, quantities, tuple(dict.fromkeys(paths)))


def _has(known: Mapping[str, int], prefix: str, field: str) -> bool:
    """Return whether the messages have a field: a number, or an array of the length that it needs."""
    bare = field.removeprefix("-")
    name, _, rest = bare.partition("[")
    length = known.get(prefix + name)
    wanted = int(rest.rstrip("]")) if rest else 0
    return length is not None and (length > 0 if bare.endswith("[0]") else length == wanted)


def _stamp(shape: Shape, known: Mapping[str, int], prefix: str) -> Stamp | None:
    """Return the stamp nearest to the measurement: in the same message, or in one that contains it."""
    parts = prefix.split(".")
    for depth in range(len(parts), 0, -1):
        around = ".".join(parts[: depth - 1]) + ("." if depth > 1 else "")
        for stamp in (*(shape.stamps if around == prefix else ()), *HEADERS):
            if all(known.get(around + field) == 0 for field in stamp.fields):
                return replace(stamp, fields=tuple(around + field for field in stamp.fields))
    return None


def stamps(values: Mapping[str, NDArray[Any]], recipe: Recipe) -> Integers | None:
    """Return the messages' own times (ns), 0 for a time that is not set or impossible; None for messages without a stamp."""
    stamp = recipe.stamp
    if stamp is None:
        return None
    parts = [values[field] for field in stamp.fields]
    if stamp.instead:
        parts = [np.where(parts[0] == 0, parts[1], parts[0])]
    if stamp.units == (SECOND, 1):
        possible = (np.abs(parts[0]) < LATEST) & (parts[1] >= 0) & (parts[1] < SECOND)
    else:
        possible = np.abs(parts[0]) < LATEST * SECOND / stamp.units[0]
        for offset in parts[1:]:
            possible &= offset != NO_OFFSET
    if not possible.all():
        parts = [np.where(possible, part, 0) for part in parts]
    whole = [part.astype(np.int64) * unit for part, unit in zip(parts, stamp.units, strict=False)]
    return whole[0] if len(whole) == 1 else whole[0] + whole[1]


def stated_orientation(batch: Batch) -> Iterator[Batch]:
    """Yield the rows of a batch that have an orientation, if any has; an orientation that is always the identity is not set."""
    quaternion = batch.columns["quaternion"]
    known = np.isfinite(quaternion).all(axis=1)
    unset = swapped_axes(np.array([1.0, 0, 0, 0])), np.array([1.0, 0, 0, 0])
    if not known.any() or any((np.abs(quaternion[known]) == np.abs(row)).all() for row in unset):
        return
    columns = {name: values[known] for name, values in batch.columns.items()}
    yield replace(batch, time=batch.time[known], columns=columns)

"""From the messages of a container's channels to batches of streams, by the names of the messages' fields."""

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from imuwb.arrays import Floats, Integers
from imuwb.errors import UnreadableLogError
from imuwb.log import BY_FILTER, MEAN_SEA_LEVEL, Effect, Kind, Origin
from imuwb.notes import Note
from imuwb.readers.batch import Batch, Remark, simulated
from imuwb.readers.bytes.gather import alike
from imuwb.readers.bytes.source import Source
from imuwb.readers.containers import shapes
from imuwb.readers.containers.decoders import CannotDecodeError, Decoder, Piece, decoder_of
from imuwb.readers.containers.messages import Channel, Container, Messages, Schema
from imuwb.readers.containers.ros_definitions import Definitions
from imuwb.readers.containers.shapes import Recipe
from imuwb.readers.containers.unused_topics import NO_QUANTITY, Unused, unused_topics
from imuwb.readers.read_options import ReadOptions

SAMPLED = 16  #: messages of a buffer that are examined for an orientation
PATIENCE = 100  #: number of messages; a channel without a known field in these is not examined again
UNIX = 10**17  #: ns; a later stamp (after March 1973) counts from 1970
ESTIMATE = "/FilterEstimate"  #: end of the name of imuwb's message for an estimate of the vehicle's own filter
NO_HEIGHT = Note("no_height", "fixes without a height: 0 is used")
NO_STAMP = Note("no_stamp", "messages without a stamp of their own: the recorder's time is used")
NO_FIT = Note("no_fit", "messages that do not fit their definition left out")
#: effects of the repairs that leave no message out
_EFFECTS: dict[Note, Effect] = {NO_HEIGHT: "value", NO_STAMP: "time"}
#: kind -> units and frame of the messages; an IMU's frame is that of REP 145, unless the user states another
_STORED: dict[Kind, tuple[str, str]] = {
    "imu": ("rad/s, m/s²", "FLU (REP 145)"), "gnss": ("deg, m", "ENU"), "velocity": ("m/s", "ENU"), "speed": ("m/s", "forward"),
    "reference": ("rad, m, m/s", "NED"), "temperature": ("°C", ""), "fix": ("", ""),
    "pose": ("m", "of its own"), "orientation": ("", "FLU relative to ENU (REP 103)"),
}  # fmt: skip


def streamed(path: Source, container: Container, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the streams of a container's messages, then notes on its faults.

    Raises:
        UnreadableLogError: the container has no whole message.
    """
    topics = Topics(container, options)
    for messages in container.messages():
        yield from topics.batches(messages)
    if not topics.count:
        why = "; ".join(container.notes) or "the recording is empty"
        raise UnreadableLogError(f"{path}: no message can be read: {why}")
    yield from map(Remark, container.notes)
    yield from topics.remarks()
    if container.truth:
        yield simulated(container.truth)


def origin_of(kind: Kind, frame: str | None, *, above_sea: bool, unix: bool = False, schema: str = "") -> Origin:
    """Return units, frame and clock of a kind of messages.

    Args:
        kind: kind of the stream.
        frame: frame of an IMU, as the user states it, or None.
        above_sea: whether heights are above mean sea level.
        unix: whether times count from 1970.
        schema: name of the messages' definition.
    """
    units, stored = _STORED[kind]
    units += f" ({MEAN_SEA_LEVEL})" if above_sea and kind in ("gnss", "reference") else ""
    stored = f"{frame} (stated)" if kind == "imu" and frame else stored
    if kind == "reference" and schema.endswith(ESTIMATE):
        stored += f", {BY_FILTER}"
    return Origin(units, stored, "unix" if unix else "log")


class Topics:
    """The topics of a container that is being read; channels and schemas are added meanwhile."""

    def __init__(self, container: Container, options: ReadOptions) -> None:
        """Set the container; nothing is read yet."""
        self.count = 0  #: messages so far
        self._container, self._options = container, options
        self._definitions = Definitions(options.messages)
        self._topics: dict[tuple[str, ...], _Topic] = {}
        self._undeclared = Counter[int]()

    def batches(self, messages: Messages) -> Iterator[Batch]:
        """Yield the streams of the messages in one buffer."""
        self.count += messages.start.size
        rows_of: dict[tuple[str, ...], list[Integers]] = defaultdict(list)
        for number, rows in alike(messages.channel, np.arange(messages.start.size)):
            channel = self._container.channels.get(number)
            if channel is None:
                self._undeclared[number] += rows.size
                continue
            schema = self._container.schemas.get(channel.schema_id)
            # The publishers of a topic have a channel each; their messages are one stream, in the file's order.
            key = channel.topic, channel.message_encoding, schema.name if schema else ""
            rows_of[key].append(rows)
            if key not in self._topics:
                above_sea = channel.topic in self._container.above_sea
                decoding = (channel, schema, self._definitions)
                self._topics[key] = _Topic(decoding, self._options, above_sea=above_sea)
        for key, parts in rows_of.items():
            rows = parts[0] if len(parts) == 1 else np.sort(np.concatenate(parts))
            yield from self._topics[key].batches(messages, rows)

    @property
    def lags(self) -> dict[str, tuple[int, int]]:
        """Return {topic: (least, largest) time of a row less the time of its recording, ns} of the topics with streams."""
        return {topic.name: topic.lag for topic in self._topics.values() if topic.lag is not None}

    def remarks(self) -> Iterator[Remark]:
        """Yield the faults of each channel."""
        for number, lost in self._undeclared.items():
            yield Remark(Note("undeclared", f"{lost} messages of channel {number}, which is not declared, left out"))
        for topic in self._topics.values():
            yield from topic.remarks()
        yield from unused_topics(topic.unused() for topic in self._topics.values() if topic.why)


class _Topic:
    """One topic: its decoder, its recipes, and its faults so far."""

    def __init__(
        self, decoding: tuple[Channel, Schema | None, Definitions], options: ReadOptions, *, above_sea: bool
    ) -> None:
        channel, schema, _ = decoding
        self.above_sea = above_sea
        self.name = channel.topic
        self.schema = schema.name if schema else ""
        self.options = options
        self.recipes: tuple[Recipe, ...] = ()
        self.decoder: Decoder | None = None
        self.why = NO_QUANTITY  #: why the topic is not used; empty if it is
        self.messages = 0
        self.faults: Counter[Note] = Counter()
        self.lag: tuple[int, int] | None = None  #: as in ``Topics.lags``
        try:
            self.decoder = decoder_of(*decoding)
        except CannotDecodeError as error:
            self.why = str(error)

    def batches(self, messages: Messages, rows: Integers) -> Iterator[Batch]:
        if self.decoder is not None and not self.recipes and self.messages < PATIENCE:
            self._recognise(self.decoder, messages, rows)
        self.messages += rows.size
        if self.decoder is None:
            return
        for recipe in self.recipes:
            if recipe.kind == "orientation" and not self._oriented(recipe, messages, rows):
                continue
            faults = self.faults if recipe.kind != "orientation" else Counter[Note]()  # they are those of the IMU
            pieces = list(self.decoder.decode(messages, rows, recipe.paths))
            lost = rows.size - sum(decoded.size for _, decoded in pieces)
            if lost:
                faults[NO_FIT] += lost
            if pieces:
                values, decoded = _in_order(pieces) if len(pieces) > 1 else pieces[0]
                batch = self._batch(recipe, values, messages, decoded, faults)
                yield from (batch,) if recipe.kind != "orientation" else shapes.stated_orientation(batch)

    def _recognise(self, decoder: Decoder, messages: Messages, rows: Integers) -> None:
        try:
            self.recipes = shapes.recognise(decoder.fields(messages, rows), self.schema, self.name)
        except CannotDecodeError as error:
            self.decoder, self.why = None, str(error)
        if self.recipes:
            self.why = ""

    def unused(self) -> Unused:
        return Unused(self.name, self.schema, self.messages, self.why)

    def remarks(self) -> Iterator[Remark]:
        for fault, count in self.faults.items():
            yield Remark(fault, self.name, count, _EFFECTS.get(fault, "lost"))

    def _oriented(self, recipe: Recipe, messages: Messages, rows: Integers) -> bool:
        """Return whether some of the messages state an orientation: most IMUs have none, and their fields need not be decoded."""
        some = rows[:: max(1, rows.size // SAMPLED)]
        pieces = self.decoder.decode(messages, some, recipe.paths) if self.decoder is not None else ()
        return any(bool(np.isfinite(self._columns(recipe, values)["quaternion"]).any()) for values, _ in pieces)

    def _columns(self, recipe: Recipe, values: Mapping[str, NDArray[Any]]) -> dict[str, Floats]:
        numbers = {path: np.asarray(array, dtype=np.float64) for path, array in values.items()}
        return recipe.columns(numbers, recipe.prefix, self.options.frame or "FLU")

    def _batch(
        self,
        recipe: Recipe,
        values: Mapping[str, NDArray[Any]],
        messages: Messages,
        rows: Integers,
        faults: Counter[Note],
    ) -> Batch:
        columns = self._columns(recipe, values)
        if recipe.kind == "gnss" and f"{recipe.prefix}altitude" not in values:
            faults[NO_HEIGHT] += rows.size
        time = self._time(recipe, values, messages, rows, faults)
        self._note_lag(time - messages.log_time[rows])
        alone = sum(other.kind == recipe.kind for other in self.recipes) == 1
        name = self.name if alone else f"{self.name}.{recipe.prefix.rstrip('.')}"
        unix = bool(time.size) and time[0] > UNIX
        origin = origin_of(recipe.kind, self.options.frame, above_sea=self.above_sea, unix=unix, schema=self.schema)
        return Batch(name, recipe.kind, time, columns, origin, messages.bytes_read)

    def _note_lag(self, lag: Integers) -> None:
        if lag.size:
            least, largest = self.lag or (lag[0], lag[0])
            self.lag = min(int(least), int(lag.min())), max(int(largest), int(lag.max()))

    def _time(
        self,
        recipe: Recipe,
        values: Mapping[str, NDArray[Any]],
        messages: Messages,
        rows: Integers,
        faults: Counter[Note],
    ) -> Integers:
        """Return the times that the options ask for; a message without a stamp has the recorder's time."""
        if self.options.time_source == "publish":
            return messages.publish_time[rows]
        recorded = messages.log_time[rows]
        if self.options.time_source == "log":
            return recorded
        stamps = shapes.stamps(values, recipe)
        unset = np.ones(rows.size, dtype=bool) if stamps is None else stamps == 0
        if stamps is not None and stamps.max() < UNIX:
            unset[:] = not stamps.any()  # the clock of a simulation may begin at 0
        if unset.any():
            faults[NO_STAMP] += int(unset.sum())
        return recorded if stamps is None else np.where(unset, recorded, stamps)


def _in_order(pieces: Sequence[Piece]) -> Piece:
    """Return pieces as one, in the file's order, which is the order of time; the pieces come layout by layout."""
    rows = np.concatenate([piece_rows for _, piece_rows in pieces])
    order = np.argsort(rows, kind="stable")
    return {path: np.concatenate([values[path] for values, _ in pieces])[order] for path in pieces[0][0]}, rows[order]

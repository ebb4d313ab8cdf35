"""From the messages of a container's channels to batches of streams, by the names of the messages' fields."""

from __future__ import annotations

from collections import Counter, defaultdict
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from imuwb.errors import UnreadableLogError
from imuwb.log import MEAN_SEA_LEVEL, Origin
from imuwb.readers.batch import Batch, ReadOptions, Remark
from imuwb.readers.bytes.gather import alike
from imuwb.readers.containers import shapes
from imuwb.readers.containers.decoders import CannotDecodeError, Decoder, decoder_of

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from imuwb.log import Effect
    from imuwb.readers.containers.decoders import Piece
    from imuwb.readers.containers.messages import Channel, Messages, Schema
    from imuwb.readers.containers.shapes import Recipe

PATIENCE = 100  #: messages after which a channel that shows no field of ours is not looked at again
UNIX = 10**17  #: ns; a stamp behind March 1973 counts from the Unix epoch
NO_HEIGHT = "fixes without a height: 0 is used"
NO_STAMP = "messages without a stamp of their own: the recorder's time is used"
_EFFECTS: dict[str, Effect] = {NO_HEIGHT: "value", NO_STAMP: "time"}  #: of a repair that leaves no message out


class Container(Protocol):
    """A file of messages that is read from its beginning to its end."""

    channels: dict[int, Channel]
    schemas: dict[int, Schema]
    remarks: list[Remark]  #: what was wrong with it, as far as it is read
    above_sea: set[str]  #: topics of which it says that heights are above mean sea level

    def messages(self) -> Iterator[Messages]:
        """Yield the messages, buffer by buffer."""
        ...


def streamed(path: Path, container: Container, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield what a container's messages hold, and what was odd.

    Raises:
        UnreadableLogError: it holds not one message.
    """
    topics = Topics(container.channels, container.schemas, options, container.above_sea)
    for messages in container.messages():
        yield from topics.batches(messages)
    if not topics.count:
        what = "; ".join(remark.text for remark in container.remarks) or "it is a recording of nothing"
        message = f"{path}: no message can be read: {what}"
        raise UnreadableLogError(message)
    yield from container.remarks
    yield from topics.remarks()


class Topics:
    """All channels of a container on their way through it; channels and schemas fill up meanwhile."""

    def __init__(
        self,
        channels: Mapping[int, Channel],
        schemas: Mapping[int, Schema],
        options: ReadOptions,
        above_sea: Collection[str] = (),
    ) -> None:
        """Remember where channels and schemas will be, and the topics with heights above mean sea level."""
        self._above_sea = above_sea
        self.count = 0  #: messages so far
        self._channels, self._schemas, self._options = channels, schemas, options
        self._topics: dict[tuple[str, ...], _Topic] = {}
        self._undeclared = Counter[int]()

    def batches(self, messages: Messages) -> Iterator[Batch]:
        """Yield what the messages of one buffer hold."""
        self.count += messages.start.size
        found: dict[tuple[str, ...], list[NDArray[np.int64]]] = defaultdict(list)
        for number, rows in alike(messages.channel, np.arange(messages.start.size)):
            channel = self._channels.get(number)
            if channel is None:
                self._undeclared[number] += rows.size
                continue
            schema = self._schemas.get(channel.schema_id)
            # Several publishers of one topic have a channel each: their messages are one stream, in the file's order.
            key = channel.topic, channel.message_encoding, schema.name if schema else ""
            found[key].append(rows)
            if key not in self._topics:
                self._topics[key] = _Topic(channel, schema, self._options, above_sea=channel.topic in self._above_sea)
        for key, parts in found.items():
            yield from self._topics[key].batches(
                messages, parts[0] if len(parts) == 1 else np.sort(np.concatenate(parts))
            )

    def remarks(self) -> Iterator[Remark]:
        """Yield what was odd about each channel."""
        for number, lost in self._undeclared.items():
            yield Remark(f"{lost} messages of channel {number}, which is not declared, left out")
        for topic in self._topics.values():
            yield from topic.remarks()


class _Topic:
    """One channel on its way through the file: how to decode it, and what was odd about it."""

    def __init__(
        self, channel: Channel, schema: Schema | None, options: ReadOptions, *, above_sea: bool = False
    ) -> None:
        self.above_sea = above_sea
        self.name = channel.topic
        self.schema = schema.name if schema else ""
        self.options = options
        self.recipes: tuple[Recipe, ...] = ()
        self.decoder: Decoder | None = None
        self.why = ""  #: why nothing of it is read
        self.messages = 0
        self.odd: Counter[str] = Counter()
        try:
            self.decoder = decoder_of(channel, schema)
        except CannotDecodeError as error:
            self.why = str(error)

    def batches(self, messages: Messages, rows: NDArray[np.int64]) -> Iterator[Batch]:
        if self.decoder is not None and not self.recipes and self.messages < PATIENCE:
            self.recipes = shapes.recognise(self.decoder.fields(messages, rows), self.schema, self.name)
        self.messages += rows.size
        if self.decoder is None:
            return
        for recipe in self.recipes:
            pieces = list(self.decoder.decode(messages, rows, recipe.paths))
            lost = rows.size - sum(rows_of.size for _, rows_of in pieces)
            if lost:
                self.odd["messages that do not fit their definition left out"] += lost
            if not pieces:
                continue
            values, found = _in_order(pieces) if len(pieces) > 1 else pieces[0]
            yield self._batch(recipe, values, messages, found)

    def remarks(self) -> Iterator[Remark]:
        if self.why:
            yield Remark(f"{self.name}: {self.messages} messages not read: {self.why}")
        elif not self.recipes:
            yield Remark(f"{self.name}: {self.messages} messages of {self.schema or 'no schema'}, not used")
        for text, count in self.odd.items():
            yield Remark(text, self.name, count, _EFFECTS.get(text, "lost"))

    def _batch(
        self, recipe: Recipe, values: Mapping[str, NDArray[Any]], messages: Messages, rows: NDArray[np.int64]
    ) -> Batch:
        numbers = {path: np.asarray(array, dtype=np.float64) for path, array in values.items()}
        frame = self.options.frame or "FLU"
        columns = recipe.columns(numbers, recipe.prefix, frame)
        if recipe.kind == "gnss" and f"{recipe.prefix}altitude" not in values:
            self.odd[NO_HEIGHT] += rows.size
        units, stored = {
            "imu": ("rad/s, m/s²", f"{frame} ({'as said' if self.options.frame else 'REP 145'})"),
            "gnss": ("deg, m", "ENU"),
            "velocity": ("m/s", "ENU"),
            "speed": ("m/s", "forward"),
            "reference": ("rad, m, m/s", "NED"),
        }.get(recipe.kind, ("°C", ""))
        units += f" ({MEAN_SEA_LEVEL})" if self.above_sea and recipe.kind in ("gnss", "reference") else ""
        time = self._time(recipe, values, messages, rows)
        alone = sum(other.kind == recipe.kind for other in self.recipes) == 1
        name = self.name if alone else f"{self.name}.{recipe.prefix.rstrip('.')}"
        origin = Origin(units, stored, "unix" if time.size and time[0] > UNIX else "log")
        return Batch(name, recipe.kind, time, columns, origin, messages.bytes_read)

    def _time(
        self, recipe: Recipe, values: Mapping[str, NDArray[Any]], messages: Messages, rows: NDArray[np.int64]
    ) -> NDArray[np.int64]:
        if self.options.time_source == "publish":
            return messages.publish_time[rows]
        recorded = messages.log_time[rows]
        if self.options.time_source == "log":
            return recorded
        stamps = shapes.stamps(values, recipe)
        unset = np.ones(rows.size, dtype=bool) if stamps is None else stamps == 0
        if stamps is not None and stamps.max() < UNIX:
            unset[:] = not stamps.any()  # a simulation's clock may well begin at 0
        if unset.any():
            self.odd[NO_STAMP] += int(unset.sum())
        return recorded if stamps is None else np.where(unset, recorded, stamps)


def _in_order(pieces: Sequence[Piece]) -> Piece:
    """Return pieces as one: groups of a layout come one behind the other; the file's order is the order of time."""
    found = np.concatenate([rows for _, rows in pieces])
    order = np.argsort(found, kind="stable")
    return {path: np.concatenate([values[path] for values, _ in pieces])[order] for path in pieces[0][0]}, found[order]

"""MCAP logs: ROS 1 and ROS 2 (cdr) through byte layouts, protobuf and JSON through their decoders."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from imuwb.errors import UnreadableLogError
from imuwb.log import Origin
from imuwb.readers import mcap_records, ros_layout, shapes
from imuwb.readers.batch import Batch, ReadOptions, Remark

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy.typing import NDArray

    from imuwb.readers.mcap_records import Channel, Messages, Schema
    from imuwb.readers.shapes import Recipe

    #: the chosen fields of messages, and which messages they are of
    Piece = tuple[Mapping[str, NDArray[Any]], NDArray[np.int64]]
    Decode = Callable[[Messages, NDArray[np.int64], Recipe], Iterator[Piece]]

format = "mcap"  # noqa: A001 - the contract's name
FIRST = 16  #: messages looked at before a channel is given up as not ours
UNIX = 10**17  #: ns; a stamp behind March 1973 counts from the Unix epoch


def probe(head: bytes) -> bool:
    """Return whether the file begins with MCAP's magic."""
    return head.startswith(mcap_records.MAGIC)


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the IMU, GNSS and temperature messages chunk by chunk.

    Raises:
        UnreadableLogError: the file holds not one message.
    """
    recording = mcap_records.Recording(path)
    topics: dict[int, _Topic] = {}
    count = 0
    for messages in recording.messages():
        count += messages.start.size
        for number in np.unique(messages.channel):
            channel = recording.channels.get(int(number))
            if channel is None:
                recording.remarks.append(Remark(f"messages of channel {number}, which is not declared, left out"))
                continue
            if number not in topics:
                topics[int(number)] = _Topic(channel, recording.schemas.get(channel.schema_id), options)
            yield from topics[int(number)].batches(messages, np.flatnonzero(messages.channel == number))
    if not count:
        what = "; ".join(remark.text for remark in recording.remarks) or "it is a recording of nothing"
        message = f"{path}: no message can be read: {what}"
        raise UnreadableLogError(message)
    yield from recording.remarks
    for topic in topics.values():
        yield from topic.remarks()


class _Topic:
    """One channel on its way through the file: how to decode it, and what was odd about it."""

    def __init__(self, channel: Channel, schema: Schema | None, options: ReadOptions) -> None:
        self.name = channel.topic
        self.schema = schema.name if schema else ""
        self.options = options
        self.why = ""  #: why nothing of it is read
        self.messages = 0
        self.odd: Counter[str] = Counter()
        self.unpack: Callable[[bytes], object] | None = None  #: for payloads that describe themselves
        self.decode, paths = self._decoder(channel, schema)
        self.recipes = shapes.recognise(paths, self.schema)

    def batches(self, messages: Messages, rows: NDArray[np.int64]) -> Iterator[Batch]:
        self.messages += rows.size
        if self.decode is None:
            return
        if self.unpack is not None and not self.recipes:
            self._learn(self.unpack, messages, rows[:FIRST])
        for recipe in self.recipes:
            for values, found in self.decode(messages, rows, recipe):
                yield self._batch(recipe, values, messages, found)

    def remarks(self) -> Iterator[Remark]:
        if self.why:
            yield Remark(f"{self.name}: {self.messages} messages not read: {self.why}")
        elif not self.recipes:
            yield Remark(f"{self.name}: {self.messages} messages of {self.schema or 'no schema'}, not used")
        for text, count in self.odd.items():
            yield Remark(text, self.name, count)

    def _batch(
        self, recipe: Recipe, values: Mapping[str, NDArray[Any]], messages: Messages, rows: NDArray[np.int64]
    ) -> Batch:
        time = {"log": messages.log_time[rows], "publish": messages.publish_time[rows]}.get(self.options.time_source)
        if time is None:
            time = shapes.stamps(values, recipe)
        if time is None:
            time = messages.log_time[rows]
            self.odd["messages without a stamp of their own: the recorder's time is used"] += rows.size
        frame = self.options.frame or "FLU"
        numbers = {path: np.asarray(array, dtype=np.float64) for path, array in values.items()}
        columns = recipe.columns(numbers, recipe.prefix, frame)
        if recipe.kind == "gnss" and f"{recipe.prefix}altitude" not in values:
            self.odd["fixes without a height: 0 is used"] += rows.size
        units, stored = {
            "imu": ("rad/s, m/s²", f"{frame} (body, {'as said' if self.options.frame else 'REP 145'})"),
            "gnss": ("deg, m", "ENU"),
        }.get(recipe.kind, ("°C", ""))
        epoch = "unix" if time.size and time[0] > UNIX else "log"
        prefix = recipe.prefix.rstrip(".") if len([r for r in self.recipes if r.kind == recipe.kind]) > 1 else ""
        name = f"{self.name}.{prefix}" if prefix else self.name
        return Batch(name, recipe.kind, time, columns, Origin(units, stored, epoch), messages.bytes_read)

    def _decoder(self, channel: Channel, schema: Schema | None) -> tuple[Decode | None, list[str]]:
        encoding = channel.message_encoding
        try:
            if encoding in ("cdr", "ros1"):
                return self._ros_decoder(encoding, schema)
            if encoding == "json":
                return self._object_decoder(_json), []
            if encoding == "protobuf":
                if schema is None:
                    self.why = "protobuf without a schema"
                    return None, []
                return self._object_decoder(_protobuf(schema)), []
        except ros_layout.UnknownLayoutError as error:
            self.why = str(error)
            return None, []
        except Exception as error:  # noqa: BLE001 - a damaged schema may raise anything in a decoder
            self.why = f"its schema cannot be used ({type(error).__name__}: {error})"
            return None, []
        self.why = f"message encoding {encoding!r} is not one of cdr, ros1, protobuf and json"
        return None, []

    def _ros_decoder(self, wire: str, schema: Schema | None) -> tuple[Decode | None, list[str]]:
        if schema is None or schema.encoding not in ("ros2msg", "ros1msg"):
            self.why = f"schema encoding {schema.encoding if schema else 'none'!r} is not ros1msg or ros2msg"
            return None, []
        if _is_service(schema.data):
            self.why = "a service's events, not a measurement"
            return None, []
        steps = ros_layout.plan(schema.name, schema.data.decode("utf-8", "replace"))

        def decode(messages: Messages, rows: NDArray[np.int64], recipe: Recipe) -> Iterator[Piece]:
            start, length = messages.start[rows], messages.length[rows]
            done = 0
            for group in ros_layout.groups(
                steps, recipe.paths, cast("ros_layout.Wire", wire), messages.buffer, start, length
            ):
                records = mcap_records.gather(messages.buffer, start[group.rows], group.dtype)
                done += group.rows.size
                yield {path: records[path] for path in recipe.paths}, rows[group.rows]
            if done < rows.size:
                self.odd["messages that do not fit their definition left out"] += rows.size - done

        return decode, [step.path for step in steps if isinstance(step, ros_layout.Field)]

    def _object_decoder(self, unpack: Callable[[bytes], object]) -> Decode:
        def decode(messages: Messages, rows: NDArray[np.int64], recipe: Recipe) -> Iterator[Piece]:
            table: list[list[object]] = []
            kept: list[int] = []
            for row in rows:
                try:
                    message = unpack(_payload(messages, row))
                    table.append([_dig(message, path) for path in recipe.paths])
                    kept.append(row)
                except Exception:  # noqa: BLE001, PERF203 - whatever a damaged message raises, it is left out and counted
                    self.odd["messages that do not fit their definition left out"] += 1
            if kept:
                columns = zip(*table, strict=True)
                yield {p: np.array(c) for p, c in zip(recipe.paths, columns, strict=True)}, np.array(kept)

        self.unpack = unpack
        return decode

    def _learn(self, unpack: Callable[[bytes], object], messages: Messages, rows: NDArray[np.int64]) -> None:
        """Learn the fields of a channel that describes itself from the first message that decodes."""
        for row in rows:
            try:
                self.recipes = shapes.recognise(list(_paths(unpack(_payload(messages, row)))), self.schema)
            except Exception:  # noqa: BLE001, S112, PERF203 - a damaged message teaches nothing; the next may
                continue
            return


def _is_service(definition: bytes) -> bool:
    """Return whether a definition is a service's: request and response parted by three dashes."""
    return any(line.strip() == b"---" for line in definition.splitlines())


def _payload(messages: Messages, row: int) -> bytes:
    start = int(messages.start[row])
    return messages.buffer[start : start + int(messages.length[row])].tobytes()


def _json(data: bytes) -> object:
    return json.loads(data)


def _protobuf(schema: Schema) -> Callable[[bytes], object]:
    from mcap.records import Schema as McapSchema  # noqa: PLC0415 - heavy, and few logs need it
    from mcap_protobuf.decoder import DecoderFactory  # noqa: PLC0415

    decoder = DecoderFactory().decoder_for("protobuf", McapSchema(1, schema.data, schema.encoding, schema.name))
    if decoder is None:
        message = f"{schema.name} is no protobuf schema"
        raise ValueError(message)
    return decoder


def _paths(message: object, prefix: str = "", depth: int = 0) -> Iterator[str]:
    """Yield the dotted paths of a decoded message's numbers and arrays of numbers."""
    if depth > ros_layout.DEEPEST:
        return
    if isinstance(message, dict):
        for name, value in cast("dict[str, object]", message).items():
            yield from _paths(value, f"{prefix}.{name}" if prefix else name, depth + 1)
    elif hasattr(message, "DESCRIPTOR"):
        for field in message.DESCRIPTOR.fields:  # pyright: ignore - protobuf's classes are made at run time
            name = f"{prefix}.{field.name}" if prefix else str(field.name)
            yield from _paths(getattr(message, field.name), name, depth + 1)
    elif isinstance(message, int | float) or (hasattr(message, "__len__") and not isinstance(message, str | bytes)):
        yield prefix


def _dig(message: object, path: str) -> object:
    for name in path.split("."):
        message = cast("dict[str, object]", message)[name] if isinstance(message, dict) else getattr(message, name)
    return list(cast("list[float]", message)) if hasattr(message, "__len__") else message

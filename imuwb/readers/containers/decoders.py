"""Decodes payloads to arrays of wanted fields. ROS is decoded by its byte layout, protobuf and JSON by their own decoders."""

import json
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from itertools import count, islice
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from imuwb import ros
from imuwb.arrays import Bytes, Integers
from imuwb.readers.bytes.gather import Field, gather
from imuwb.readers.containers import ros_idl, ros_layout
from imuwb.readers.containers.messages import Channel, Messages, Schema
from imuwb.readers.containers.ros_definitions import Definitions
from imuwb.readers.containers.unused_topics import NO_QUANTITY

Piece = tuple[Mapping[str, NDArray[Any]], Integers]

IDL = ("ros2idl", "omgidl")  #: names of the other language of definitions
GIVE = "give its .msg files with --messages DIR"
FIRST = 16  #: number of messages that are tried for the fields of a channel without a definition


class CannotDecodeError(Exception):
    """A channel's messages cannot be decoded; the text states why."""


class _RosDecoder:
    """Decodes by the definition that the log holds, or else by the definition elsewhere that fits the messages."""

    def __init__(self, schema: Schema | None, wire: ros_layout.Wire, definitions: Definitions) -> None:
        if schema is None:
            raise CannotDecodeError("it has no schema, which states the type of its messages")
        self._wire: ros_layout.Wire = wire
        own = _own_definition(schema)
        if any(line.strip() == "---" for line in own.splitlines()):
            raise CannotDecodeError("these are events of a service, not measurements")
        self._plan: ros_layout.Plan | None = None  #: None until messages show which form fits them
        self._forms: list[tuple[ros_layout.Plan, bool]] = []
        why = _no_definition(schema)
        for text in (own,) if own else definitions.whole(schema.name):
            try:
                self._forms.append(ros_layout.whole_plan(schema.name, text, definitions.part))
            except ros_layout.UnknownLayoutError as error:
                why = f"{error}; {GIVE}" if "not defined" in str(error) else str(error)
        if not self._forms:
            raise CannotDecodeError(why)
        if own:
            self._plan = self._forms[0][0]

    @property
    def defined(self) -> bool:
        """Whether the fields are known without a message."""
        return self._plan is not None

    def fields(self, messages: Messages, rows: Integers) -> dict[str, int]:
        if self._plan is None:
            self._plan = self._fitting(messages, rows[:FIRST])
        times = Counter(step.path for step in self._plan)  # a damaged definition may have a name twice
        numbers = (step for step in self._plan if isinstance(step, ros_layout.LayoutField))
        return {step.path: step.count for step in numbers if times[step.path] == 1}

    def texts(self, messages: Messages, rows: Integers, path: str) -> Iterator[bytes]:
        for row in rows:
            yield ros_layout.text(self._plan or (), self._wire, _payload(messages, row), path)

    def _fitting(self, messages: Messages, rows: Integers) -> ros_layout.Plan:
        """Return the plan that fits most of some messages, and at least half of them, with the fewest bytes left."""
        payloads = [_payload(messages, row) for row in rows]
        found: dict[tuple[int, int], ros_layout.Plan] = {}
        for steps, whole in self._forms:
            rests = [ros_layout.surplus(steps, self._wire, payload, whole=whole) for payload in payloads]
            known = [rest for rest in rests if rest is not None]
            if 2 * len(known) >= len(rests):
                found.setdefault((len(rests) - len(known), sum(known)), steps)
        if not found:
            raise CannotDecodeError(f"no definition that is known fits its messages; {GIVE}")
        return found[min(found)]

    def decode(self, messages: Messages, rows: Integers, paths: tuple[str, ...]) -> Iterator[Piece]:
        start, length = messages.start[rows], messages.length[rows]
        for group in ros_layout.groups(self._plan or (), paths, self._wire, messages.buffer, start, length):
            yield _gathered(messages.buffer, start[group.rows], group.places), rows[group.rows]


def _own_definition(schema: Schema) -> str:
    """Return the definition that the log holds, in ROS's own language; an empty text if it holds none."""
    text = schema.data.decode("utf-8", "replace")
    if schema.encoding in ("ros2msg", "ros1msg"):
        return text if text.strip() else ""
    if schema.encoding not in IDL:
        return ""
    types = ros_idl.converted(text)
    main = types.pop(ros.short(schema.name), "")
    return "===\n".join([main, *(f"MSG: {name}\n{fields}" for name, fields in types.items())]) if main else ""


def _no_definition(schema: Schema) -> str:
    """Return why a type without a definition is not used."""
    if ros.short(schema.name).partition("/")[0] in ros.WELL_KNOWN:
        return NO_QUANTITY
    if schema.data and schema.encoding not in ("", "none", "ros2msg", "ros1msg"):
        return f"its definition in the language {schema.encoding!r} is not read; {GIVE}"
    return f"the log does not hold its definition; {GIVE}"


def _gathered(buffer: Bytes, at: Integers, places: tuple[Field, ...]) -> dict[str, NDArray[Any]]:
    """Return fields; numbers that follow each other, such as x, y and z, are columns of one array."""
    fields: dict[str, NDArray[Any]] = {}
    first = 0
    while first < len(places):
        place, after = places[first], first + 1
        while after < len(places) and _continues(places[after - 1], places[after]):
            after += 1
        if after == first + 1:
            fields[place.name] = gather(buffer, at + place.offset, place.kind, place.count)
        else:
            block = gather(buffer, at + place.offset, place.kind, after - first)
            fields |= {p.name: block[:, i] for i, p in enumerate(places[first:after])}
        first = after
    return fields


def _continues(place: Field, after: Field) -> bool:
    return place.kind == after.kind and not place.count and not after.count and place.end == after.offset


class _ObjectDecoder:
    """Decodes each payload to an object; the first that decodes shows the fields."""

    defined = False

    def __init__(self, unpack: Callable[[bytes], object]) -> None:
        self._unpack = unpack

    def fields(self, messages: Messages, rows: Integers) -> dict[str, int]:
        for row in rows[:FIRST]:
            try:
                return dict(islice(_paths(self._unpack(_payload(messages, row)), count()), ros_layout.LONGEST_PLAN))
            except Exception:  # noqa: BLE001, S112 - a damaged message shows no fields; the next may
                continue
        return {}

    def texts(self, messages: Messages, rows: Integers, path: str) -> Iterator[bytes]:
        for row in rows:
            try:
                yield str(_found(self._unpack(_payload(messages, row)), path)).encode()
            except Exception:  # noqa: BLE001, S112 - a damaged message may raise anything; it is left out
                continue

    def decode(self, messages: Messages, rows: Integers, paths: tuple[str, ...]) -> Iterator[Piece]:
        table: list[list[float | list[float]]] = []
        decoded: list[int] = []
        for row in rows:
            try:
                message = self._unpack(_payload(messages, row))
                numbers = [_dig(message, path) for path in paths]
                if table and [np.shape(x) for x in numbers] != [np.shape(x) for x in table[0]]:
                    continue  # an array of another length than the first message's
                table.append(numbers)
                decoded.append(int(row))
            except Exception:  # noqa: BLE001, S112 - a damaged message may raise anything; it is left out
                continue
        if decoded:
            arrays = [np.array(column) for column in zip(*table, strict=True)]
            yield dict(zip(paths, arrays, strict=True)), np.array(decoded)


#: ``fields(messages, rows)`` returns {dotted path: length} of the messages' numbers (length 0) and arrays, from the definition or
#: from some of the rows; ``texts(messages, rows, path)`` yields a text of each; ``decode(messages, rows, paths)`` yields the fields in pieces; a message that does not fit its definition is in no piece.
Decoder = _RosDecoder | _ObjectDecoder


def decoder_of(channel: Channel, schema: Schema | None, definitions: Definitions) -> Decoder:
    """Return the decoder of a channel.

    Args:
        channel: the channel.
        schema: the definition of its messages in the log.
        definitions: definitions elsewhere, for a log that does not hold them.

    Raises:
        CannotDecodeError: the channel has no decoder.
    """
    encoding = channel.message_encoding
    if encoding in ("cdr", "ros1"):
        return _RosDecoder(schema, encoding, definitions)
    if encoding == "json":
        return _ObjectDecoder(json.loads)
    if encoding == "protobuf":
        return _ObjectDecoder(_protobuf(schema))
    raise CannotDecodeError(f"message encoding {encoding!r} is not supported; cdr, ros1, protobuf and json are")


def _payload(messages: Messages, row: int) -> bytes:
    start = int(messages.start[row])
    return messages.buffer[start : start + int(messages.length[row])].tobytes()


def _protobuf(schema: Schema | None) -> Callable[[bytes], object]:
    from mcap.records import Schema as McapSchema  # noqa: PLC0415 - slow to import, and few logs need it

    try:
        from mcap_protobuf.decoder import DecoderFactory  # noqa: PLC0415
    except ImportError as error:  # not every distributor of packages has it
        raise CannotDecodeError("protobuf needs the package mcap-protobuf-support; install it with pip") from error
    if schema is None:
        raise CannotDecodeError("its protobuf schema is missing")
    try:
        decoder = DecoderFactory().decoder_for(
            "protobuf", McapSchema(id=1, data=schema.data, encoding=schema.encoding, name=schema.name)
        )
    except Exception as error:
        raise CannotDecodeError(f"its protobuf schema is damaged ({type(error).__name__}: {error})") from error
    if decoder is None:
        raise CannotDecodeError(f"its schema {schema.name} is not protobuf")
    return decoder


def _paths(message: Any, looked: Iterator[int], prefix: str = "", depth: int = 0) -> Iterator[tuple[str, int]]:  # noqa: ANN401 - any decoded object
    """Yield (dotted path, length) of a decoded message's numbers (length 0) and arrays of numbers.

    No more than so many fields are looked at: a type of protobuf may contain itself.
    """
    if depth > ros_layout.DEEPEST or next(looked) > ros_layout.LONGEST_PLAN:
        return
    if isinstance(message, dict):
        for name, value in cast("dict[str, object]", message).items():
            yield from _paths(value, looked, f"{prefix}.{name}" if prefix else name, depth + 1)
    elif hasattr(message, "DESCRIPTOR"):
        for field in message.DESCRIPTOR.fields:
            name = f"{prefix}.{field.name}" if prefix else str(field.name)
            yield from _paths(getattr(message, field.name), looked, name, depth + 1)
    elif isinstance(message, int | float):
        yield prefix, 0
    elif hasattr(message, "__len__") and not isinstance(message, str | bytes) and len(message):
        yield prefix, len(message)


def _found(message: object, path: str) -> object:
    for name in path.split("."):
        message = cast("dict[str, object]", message)[name] if isinstance(message, dict) else getattr(message, name)
    return message


def _dig(message: object, path: str) -> float | list[float]:
    whole, first, _ = path.partition("[0]")
    value = _found(message, whole)
    if first:
        numbers = cast("list[float]", value)
        return float(numbers[0]) if len(numbers) else 0.0
    if hasattr(value, "__len__") and not isinstance(value, str | bytes):
        return [float(x) for x in cast("list[float]", value)]
    return float(cast("float", value))

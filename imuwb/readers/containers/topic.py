"""One topic of a container: from its messages to batches of streams."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from imuwb.arrays import Floats, Integers
from imuwb.geodesy.tangent_plane import geodetic
from imuwb.log import BY_FILTER, MEAN_SEA_LEVEL, Effect, Origin
from imuwb.notes import Note
from imuwb.readers.batch import Batch, Remark
from imuwb.readers.containers import shapes
from imuwb.readers.containers.decoders import CannotDecodeError, Decoder, Piece, decoder_of
from imuwb.readers.containers.frames import Frames
from imuwb.readers.containers.half_imus import SENSORS, Halves
from imuwb.readers.containers.known_shapes import SHAPES, is_receiver
from imuwb.readers.containers.messages import Channel, Messages, Schema
from imuwb.readers.containers.packed_messages import are_packed, unpacked_messages
from imuwb.readers.containers.ros_definitions import Definitions
from imuwb.readers.containers.sentence_topic import TYPE as SENTENCE
from imuwb.readers.containers.sentence_topic import SentenceTopic
from imuwb.readers.containers.shapes import Recipe
from imuwb.readers.containers.unused_topics import NO_QUANTITY, Unused
from imuwb.readers.read_options import ReadOptions
from imuwb.ros import short

IMU = (
    "sensor_msgs/Imu"  #: type of messages that are told apart by the frame in their header, in encodings that have one
)
HEADED = ("cdr", "ros1")
SAMPLED = 16  #: messages of a buffer that are examined for an orientation
PATIENCE = 100  #: number of messages; a channel without a known field in these is not examined again
UNIX = 10**17  #: ns; a later stamp (after March 1973) counts from 1970
ESTIMATE = "/FilterEstimate"  #: end of the name of imuwb's message for an estimate of the vehicle's own filter
EARTH = 6.3e6, 6.5e6  #: m; poses at such distances from the origin of their frame are earth-centred
LEAST_FORCE = 3.0  #: m/s²; a smaller median of accelerations shows that gravity is taken out
NO_HEIGHT = Note("no_height", "fixes without a height: 0 is used")
NO_STAMP = Note("no_stamp", "messages without a stamp of their own: the recorder's time is used")
NO_FIT = Note("no_fit", "messages that do not fit their definition left out")
NO_POSITION = Note("no_position", "messages without a position (0/0: no fix yet) left out")
#: effects of the repairs that leave no message out
_EFFECTS: dict[Note, Effect] = {NO_HEIGHT: "value", NO_STAMP: "time"}


def recognise(known: Mapping[str, int], schema: str, topic: str) -> tuple[tuple[Recipe, ...], str]:
    """Return the recipes for a topic's messages, and why the topic is not used; empty if it is.

    Args:
        known: {path of a field: length of its array, 0 for a number}.
        schema: name of the messages' type.
        topic: their topic.
    """
    recipes = shapes.recognised(known, schema, topic, SHAPES)
    used = tuple(recipe for recipe in recipes if not recipe.shape.refused)
    return used, "" if used else next((recipe.shape.refused for recipe in recipes), NO_QUANTITY)


def origin_of(
    recipe: Recipe, frame: str | None, *, above_sea: bool = False, unix: bool = False, schema: str = ""
) -> Origin:
    """Return units, frame and clock of a stream's messages.

    Args:
        recipe: of the stream.
        frame: frame of an IMU, as the user states it, or None.
        above_sea: whether heights are above mean sea level.
        unix: whether times count from 1970.
        schema: name of the messages' definition.
    """
    units, stored = recipe.shape.units, recipe.shape.frame
    if above_sea and recipe.kind in ("gnss", "reference"):
        units += f" ({MEAN_SEA_LEVEL})"
    if recipe.kind == "imu" and frame:
        stored = f"{frame} (stated)"
    if recipe.kind == "reference" and schema.endswith(ESTIMATE):
        stored += f", {BY_FILTER}"
    return Origin(units, stored, "unix" if unix else "log")


@dataclass(frozen=True, slots=True)
class Decoding:
    """What is known of a topic before its first message."""

    channel: Channel
    schema: Schema | None
    definitions: Definitions
    above_sea: bool = False


class Topic:
    """One topic: its decoder, its recipes, and its faults so far."""

    def __init__(self, decoding: Decoding, options: ReadOptions) -> None:
        """Set what is known; no message is read yet."""
        self.name, self.options = decoding.channel.topic, options
        self.above_sea = decoding.above_sea
        self.schema = decoding.schema.name if decoding.schema else ""
        self.recipes: tuple[Recipe, ...] = ()
        self.decoder: Decoder | None = None
        self.why = NO_QUANTITY  #: why the topic is not used; empty if it is
        self.messages = 0
        self.faults: Counter[Note] = Counter()
        self.lag: tuple[int, int] | None = None  #: (least, largest) time of a row less the time of its recording, ns
        self._halves: dict[tuple[Recipe, str], Halves] = {}  #: by recipe and frame
        self._frames = Frames() if short(self.schema) == IMU and decoding.channel.message_encoding in HEADED else None
        self._by_recorder: bool | None = None  #: whether no message has a stamp of its own; None before the first
        self.sentences = SentenceTopic() if short(self.schema) == SENTENCE else None
        try:
            self.decoder = decoder_of(decoding.channel, decoding.schema, decoding.definitions)
        except CannotDecodeError as error:
            self.why = str(error)

    def batches(self, messages: Messages, rows: Integers) -> Iterator[Batch]:
        """Yield the streams of some messages."""
        if are_packed(messages, rows):
            messages, rows = unpacked_messages(messages, rows), np.arange(rows.size)
        if self.decoder is not None and not self.recipes and self.messages < PATIENCE:
            self._recognise(self.decoder, messages, rows)
        self.messages += rows.size
        if self.decoder is None:
            return
        if self.sentences is not None:
            self.sentences.take(self.decoder, messages, rows)
        parts = (("", rows),) if self._frames is None else self._frames.parted(messages, rows)
        for frame, own in parts:
            yield from self._of_frame(self.decoder, frame, messages, own)

    def _of_frame(self, decoder: Decoder, frame: str, messages: Messages, rows: Integers) -> Iterator[Batch]:
        """Yield the streams of messages with one frame."""
        for recipe in self.recipes:
            if recipe.kind == "orientation" and not self._oriented(recipe, messages, rows):
                continue
            faults = self.faults if recipe.kind != "orientation" else Counter[Note]()  # they are those of the IMU
            pieces = list(decoder.decode(messages, rows, recipe.paths))
            lost = rows.size - sum(decoded.size for _, decoded in pieces)
            if lost:
                faults[NO_FIT] += lost
            if pieces:
                values, decoded = _in_order(pieces) if len(pieces) > 1 else pieces[0]
                yield from self._finished(recipe, frame, self._batch(recipe, frame, values, messages, decoded, faults))

    def _recognise(self, decoder: Decoder, messages: Messages, rows: Integers) -> None:
        try:
            self.recipes, self.why = recognise(decoder.fields(messages, rows), self.schema, self.name)
        except CannotDecodeError as error:
            self.decoder, self.why = None, str(error)

    def rest(self, bytes_read: int) -> Iterator[Batch | Remark]:
        """Yield what is known at the end only."""
        for halves in self._halves.values():
            yield from halves.rest()
        if self.sentences is not None:
            for part in self.sentences.fixes(self.name, bytes_read):
                self.why = "" if isinstance(part, Batch) else self.why
                yield part

    def unused(self) -> Unused:
        """Return the topic as one that is not used."""
        return Unused(self.name, self.schema, self.messages, self.why)

    def remarks(self) -> Iterator[Remark]:
        """Yield the faults of the messages."""
        for fault, count in self.faults.items():
            yield Remark(fault, self.name, count, _EFFECTS.get(fault, "lost"))
        for (recipe, frame), halves in self._halves.items():
            yield from halves.remarks(self._stream(recipe, frame))

    def _oriented(self, recipe: Recipe, messages: Messages, rows: Integers) -> bool:
        """Return whether some of the messages state an orientation: most IMUs have none, and their fields need not be decoded."""
        some = rows[:: max(1, rows.size // SAMPLED)]
        pieces = self.decoder.decode(messages, some, recipe.paths) if self.decoder is not None else ()
        return any(bool(np.isfinite(self._columns(recipe, values)["quaternion"]).any()) for values, _ in pieces)

    def _columns(self, recipe: Recipe, values: Mapping[str, NDArray[Any]]) -> dict[str, Floats]:
        numbers = {path: np.asarray(array, dtype=np.float64) for path, array in values.items()}
        return recipe.columns(numbers, self.options.frame)

    def _stream(self, recipe: Recipe, frame: str) -> str:
        """Return the name of a recipe's stream: that of the topic, with the frame if it has several, and the place in the message."""
        prefixes = {other.prefix for other in self.recipes if other.kind == recipe.kind}
        place = recipe.prefix.rstrip(".") if len(prefixes) > 1 else ""
        return ".".join(filter(None, (self.name, frame, place, recipe.shape.part)))

    def _batch(
        self,
        recipe: Recipe,
        frame: str,
        values: Mapping[str, NDArray[Any]],
        messages: Messages,
        rows: Integers,
        faults: Counter[Note],
    ) -> Batch:
        columns = self._columns(recipe, values)
        if recipe.kind == "gnss" and recipe.lacks_height:
            faults[NO_HEIGHT] += rows.size
        time = self._time(recipe, values, messages, rows, faults)
        self._note_lag(time - messages.log_time[rows])
        unix = bool(time.size) and time[0] > UNIX
        origin = origin_of(recipe, self.options.frame, above_sea=self.above_sea, unix=unix, schema=self.schema)
        return Batch(self._stream(recipe, frame), recipe.kind, time, columns, origin, messages.bytes_read)

    def _finished(self, recipe: Recipe, frame: str, batch: Batch) -> Iterator[Batch]:
        """Yield the rows of a batch that are measurements."""
        if batch.kind == "orientation":
            yield from shapes.stated_orientation(batch)
        elif batch.kind == "imu":
            if recipe.shape.gravity and not self._feels_gravity(recipe, frame, batch):
                return
            sensors = tuple(quantity.column for quantity in recipe.quantities if quantity.column in SENSORS)
            yield from self._halves.setdefault((recipe, frame), Halves()).parted(batch, sensors)
        elif batch.kind == "pose" and _is_earth_centred(batch.columns["position"]):
            yield _geodetic(batch, self.name)
        elif batch.kind in ("gnss", "reference") and "position" in batch.columns:
            yield from self._located(batch)
        else:
            yield batch

    def _feels_gravity(self, recipe: Recipe, frame: str, batch: Batch) -> bool:
        """Return whether accelerations contain gravity; those of the first messages decide whether the topic is used."""
        force = batch.columns.get("specific_force")
        if (recipe, frame) in self._halves or force is None:
            return True
        median = float(np.median(np.linalg.norm(force, axis=1)))
        if median < LEAST_FORCE:
            self.recipes = tuple(other for other in self.recipes if other is not recipe)
            self.why = f"accelerations without gravity (their median is {median:.2g} m/s²) are no specific forces"
            self.decoder = self.decoder if self.recipes else None
        return median >= LEAST_FORCE

    def _located(self, batch: Batch) -> Iterator[Batch]:
        """Yield the rows that have a position; a receiver without a fix states latitude 0 and longitude 0."""
        there = batch.columns["position"][:, :2].any(axis=1)
        if there.all():
            yield batch
            return
        self.faults[NO_POSITION] += int(np.count_nonzero(~there))
        columns = {name: values[there] for name, values in batch.columns.items()}
        yield replace(batch, time=batch.time[there], columns=columns)

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
        if self._by_recorder is None:
            self._by_recorder = bool(unset.all())
        if stamps is not None and stamps.max() < UNIX:
            # The clock of a simulation may begin at 0. Two clocks are not mixed: that of the first messages counts.
            unset[:] = self._by_recorder
        if unset.any():
            faults[NO_STAMP] += int(unset.sum())
        return recorded if stamps is None else np.where(unset, recorded, stamps)


def _is_earth_centred(position: Floats) -> bool:
    """Return whether positions, (n, 3) m, count from the centre of the Earth (the frame "earth" of REP 105)."""
    distance = np.linalg.norm(np.where(np.abs(position) < 10 * EARTH[1], position, np.nan), axis=1)
    return bool(((distance > EARTH[0]) & (distance < EARTH[1])).all())


def _geodetic(batch: Batch, topic: str) -> Batch:
    """Return earth-centred poses as the positions of a receiver, or of the vehicle's filter."""
    receiver = is_receiver(topic)
    columns = {"position": geodetic(batch.columns["position"])}
    frame = "earth-centred (REP 105)" if receiver else f"earth-centred (REP 105), {BY_FILTER}"
    origin = replace(batch.origin, frame=frame)
    return replace(batch, kind="gnss" if receiver else "reference", columns=columns, origin=origin)


def _in_order(pieces: Sequence[Piece]) -> Piece:
    """Return pieces as one, in the file's order, which is the order of time; the pieces come layout by layout."""
    rows = np.concatenate([piece_rows for _, piece_rows in pieces])
    order = np.argsort(rows, kind="stable")
    return {path: np.concatenate([values[path] for values, _ in pieces])[order] for path in pieces[0][0]}, rows[order]

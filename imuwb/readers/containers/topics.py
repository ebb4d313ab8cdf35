"""From the messages of a container's channels to batches of streams, by the names of the messages' fields."""

from collections import Counter, defaultdict
from collections.abc import Iterator

import numpy as np

from imuwb.arrays import Integers
from imuwb.errors import UnreadableLogError
from imuwb.notes import Note
from imuwb.readers.batch import Batch, Remark, simulated
from imuwb.readers.bytes.gather import alike
from imuwb.readers.bytes.source import Source
from imuwb.readers.containers.messages import Container, Messages
from imuwb.readers.containers.ros_definitions import Definitions
from imuwb.readers.containers.topic import UNIX, Decoding, Topic
from imuwb.readers.containers.unused_topics import MOST_NAMES, unused_topics
from imuwb.readers.read_options import ReadOptions
from imuwb.texts import names_text, seconds_text
from imuwb.units import SECOND

MOST_TOPICS = 4096  #: topics that are read; no robot has so many
APART = 10 * SECOND  #: ns; stamps that differ from the times of recording by more are of another clock


def streamed(path: Source, container: Container, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the streams of a container's messages, then notes on its faults.

    Raises:
        UnreadableLogError: the container has no whole message.
    """
    topics = Topics(container, options)
    for messages in container.messages():
        yield from topics.batches(messages)
        del messages  # their buffer may be large
    if not topics.count:
        why = "; ".join(container.notes) or "the recording is empty"
        raise UnreadableLogError(f"{path}: no message can be read: {why}")
    yield from topics.rest()
    yield from map(Remark, container.notes)
    yield from topics.remarks()
    if container.truth:
        yield simulated(container.truth)


class Topics:
    """The topics of a container that is being read; channels and schemas are added meanwhile."""

    def __init__(self, container: Container, options: ReadOptions) -> None:
        """Set the container; nothing is read yet."""
        self.count = 0  #: messages so far
        self._container, self._options = container, options
        self._definitions = Definitions(options.messages)
        self._topics: dict[tuple[str, ...], Topic] = {}
        self._undeclared = Counter[int]()
        self._beyond = Counter[int]()  #: messages of the channels after the first ``MOST_TOPICS``
        self._bytes_read = 0

    def batches(self, messages: Messages) -> Iterator[Batch]:
        """Yield the streams of the messages in one buffer."""
        self.count += messages.start.size
        self._bytes_read = messages.bytes_read
        rows_of: dict[tuple[str, ...], list[Integers]] = defaultdict(list)
        for number, rows in alike(messages.channel, np.arange(messages.start.size)):
            channel = self._container.channels.get(number)
            if channel is None:
                self._undeclared[number] += rows.size
                continue
            schema = self._container.schemas.get(channel.schema_id)
            # The publishers of a topic have a channel each; their messages are one stream, in the file's order.
            key = channel.topic, channel.message_encoding, schema.name if schema else ""
            if key not in self._topics and len(self._topics) >= MOST_TOPICS:
                self._beyond.update({number: rows.size})
                continue
            rows_of[key].append(rows)
            if key not in self._topics:
                above_sea = channel.topic in self._container.above_sea
                self._topics[key] = Topic(Decoding(channel, schema, self._definitions, above_sea), self._options)
        for key, parts in rows_of.items():
            rows = parts[0] if len(parts) == 1 else np.sort(np.concatenate(parts))
            yield from self._topics[key].batches(messages, rows)

    @property
    def waiting(self) -> bool:
        """Whether a topic has streams that are known only when all messages are read."""
        return any(topic.sentences is not None for topic in self._topics.values())

    def rest(self) -> Iterator[Batch | Remark]:
        """Yield the streams that are known only when all messages are read."""
        for topic in self._topics.values():
            yield from topic.rest(self._bytes_read)

    @property
    def lags(self) -> dict[str, tuple[int, int]]:
        """Return {topic: (least, largest) time of a row less the time of its recording, ns} of the topics with streams."""
        return {topic.name: topic.lag for topic in self._topics.values() if topic.lag is not None}

    def remarks(self) -> Iterator[Remark]:
        """Yield the faults of each channel."""
        for number, lost in self._undeclared.most_common(MOST_NAMES):
            yield Remark(Note("undeclared", f"{lost} messages of channel {number}, which is not declared, left out"))
        if len(self._undeclared) > MOST_NAMES:
            rest = self._undeclared.total() - sum(lost for _, lost in self._undeclared.most_common(MOST_NAMES))
            text = (
                f"{rest} messages of {len(self._undeclared) - MOST_NAMES} other channels that are not declared left out"
            )
            yield Remark(Note("undeclared", text))
        if self._beyond:
            text = f"{self._beyond.total()} messages of {len(self._beyond)} channels left out: no more than {MOST_TOPICS} topics are read"
            yield Remark(Note("too_many_topics", text))
        for topic in self._topics.values():
            yield from topic.remarks()
        yield from map(Remark, self._other_clocks())
        yield from unused_topics(topic.unused() for topic in self._topics.values() if topic.why)

    def _other_clocks(self) -> Iterator[Note]:
        """Yield a note for the topics whose stamps are far from the times of recording, in groups of equal distances."""
        groups: dict[int, list[str]] = defaultdict(list)
        for name, (least, largest) in self.lags.items():
            if min(abs(least), abs(largest)) > APART and (least > 0) == (largest > 0):
                groups[round((least + largest) / 2 / APART)].append(name)
        for distance, names in groups.items():
            lag = distance * (APART // SECOND)
            where = "after" if lag > 0 else "before"
            boot = ", as they count from power-up or another start" if -lag * SECOND > UNIX else ""
            yield Note(
                "other_clock",
                f"{names_text(names)}: stamps are {seconds_text(abs(lag))} {where} the times of recording{boot}; "
                "--time-source log uses the times of recording",
            )

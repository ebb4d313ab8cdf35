"""Messages of several sensors on one topic, which only the frame in their headers tells apart.

In ROS 1 and in little-endian CDR alike, a header's frame is a text whose length, a uint32, begins at byte 12 of the message.
"""

from collections import Counter
from collections.abc import Iterator

import numpy as np

from imuwb.arrays import Integers
from imuwb.readers.containers.messages import Messages

LENGTH, TEXT = 12, 16  #: bytes before the length, and before the text
LONGEST = 256  #: bytes; a longer text is no name of a frame
FIRST = 64  #: messages that show whether several sensors take turns on a topic
FEWEST, SHARE = 2, 0.15  #: least number and share of each sensor's messages among these


class Frames:
    """The frames of the messages of one topic."""

    def __init__(self) -> None:
        """No message is read yet."""
        self._known: list[str] | None = None  #: of sensors that take turns; empty for a topic of one sensor

    def parted(self, messages: Messages, rows: Integers) -> Iterator[tuple[str, Integers]]:
        """Yield the name of each frame and its rows; an empty name and all rows for a topic of one sensor.

        Args:
            messages: of all topics.
            rows: those of this topic, whose messages begin with a header.
        """
        if self._known is None and rows.size > 1:
            counts = Counter(filter(None, _names(messages, rows[:FIRST])))
            least = max(FEWEST, SHARE * counts.total())
            known = [name for name, count in counts.items() if count >= least]
            self._known = known if 1 < len(known) == len(counts) else []
        if not self._known:
            yield "", rows
            return
        names = np.array([name if name in self._known else self._known[0] for name in _names(messages, rows)])
        for name in self._known:
            if (own := names == name).any():
                yield name, rows[own]


def _names(messages: Messages, rows: Integers) -> list[str]:
    """Return the frame of each message; an empty text for a message that has none."""
    data = messages.buffer.data
    found: list[str] = []
    for start, size in zip(messages.start[rows].tolist(), messages.length[rows].tolist(), strict=True):
        length = int.from_bytes(data[start + LENGTH : start + TEXT], "little")
        text = data[start + TEXT : start + TEXT + length] if length <= min(LONGEST, size - TEXT) else b""
        found.append(bytes(text).rstrip(b"\0").decode("utf-8", "replace"))
    return found

"""A large MCAP file that is not stored: one chunk over and over, and an index of all of them. https://mcap.dev/spec."""

import struct
from dataclasses import dataclass

MAGIC = b"\x89MCAP0\r\n"


@dataclass(frozen=True)
class Repeated:
    """Bytes with a part that is repeated."""

    head: bytes
    part: bytes
    count: int
    tail: bytes
    tag: str = "large"

    def __len__(self) -> int:
        return len(self.head) + len(self.part) * self.count + len(self.tail)

    def __getitem__(self, wanted: slice) -> bytes:
        start, stop, _ = wanted.indices(len(self))
        pieces, at = [], start
        while at < stop:
            inside = at - len(self.head)
            if inside < 0:
                piece = self.head[at:stop]
            elif inside < len(self.part) * self.count:
                offset = inside % len(self.part)
                piece = self.part[offset : offset + stop - at]
            else:
                offset = inside - len(self.part) * self.count
                piece = self.tail[offset : offset + stop - at]
            pieces.append(piece)
            at += len(piece)
        return b"".join(pieces)


def _record(opcode, content):
    return struct.pack("<BQ", opcode, len(content)) + content


def _text(text):
    data = text if isinstance(text, bytes) else text.encode()
    return struct.pack("<I", len(data)) + data


def _numbers(pairs):
    return struct.pack("<I", 10 * len(pairs)) + b"".join(struct.pack("<HQ", *pair) for pair in pairs)


def large_mcap(channels, size, chunks, start, step):
    """Return an MCAP file without compression.

    Args:
        channels: (topic, schema, schema encoding, definition, message encoding, payload) each; each chunk has one message of each.
        size: bytes of the records of a chunk; the rest is one large message of the last channel.
        chunks: number of chunks.
        start: time (ns) of the first chunk.
        step: ns from a chunk to the next.
    """
    declared = b""
    for i, (topic, schema, schema_encoding, definition, encoding, _) in enumerate(channels, 1):
        declared += _record(0x03, struct.pack("<H", i) + _text(schema) + _text(schema_encoding) + _text(definition))
        declared += _record(0x04, struct.pack("<HH", i, i) + _text(topic) + _text(encoding) + _text(b""))
    messages = declared + b"".join(
        _record(0x05, struct.pack("<HIQQ", i + 1, 0, start, start) + channel[5]) for i, channel in enumerate(channels)
    )
    messages += _record(0x05, struct.pack("<HIQQ", len(channels), 0, start, start) + bytes(size - len(messages) - 31))
    chunk = _record(
        0x06,
        struct.pack("<QQQI", start, start, len(messages), 0) + _text("") + struct.pack("<Q", len(messages)) + messages,
    )
    head = MAGIC + _record(0x01, _text("") + _text("test"))
    part = chunk
    data_end = _record(0x0F, bytes(4))
    summary = declared
    counts = [(i + 1, chunks * (1 + (i == len(channels) - 1))) for i in range(len(channels))]
    end = start + step * chunks
    summary += _record(
        0x0B,
        struct.pack("<QHIIIIQQ", sum(n for _, n in counts), len(channels), len(channels), 0, 0, chunks, start, end)
        + _numbers(counts),
    )
    for i in range(chunks):
        at, time = len(head) + i * len(part), start + step * i
        offsets = [(number, at + len(chunk)) for number, _ in counts]
        summary += _record(
            0x08, struct.pack("<QQQQ", time, time + step, at, len(chunk)) + _numbers(offsets) + struct.pack("<Q", 0)
            + _text("") + struct.pack("<QQ", len(messages), len(messages)),
        )  # fmt: skip
    at_summary = len(head) + chunks * len(part) + len(data_end)
    footer = _record(0x02, struct.pack("<QQI", at_summary, 0, 0))
    return Repeated(head, part, chunks, data_end + summary + footer + MAGIC)

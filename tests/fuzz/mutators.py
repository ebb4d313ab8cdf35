"""Damage to logs that knows their structure: one part is changed, and lengths and checksums around it are made right again.

A log is a list of parts: records, messages, frames, sentences or lines. ``apart`` takes a log to pieces, and ``together`` makes a log of
them, with right lengths, checksums and packing. ``damaged`` changes parts, or the bytes of the file as they are. ``spoilt`` changes a part
and leaves its checksum as it was, so that a reader must not use it.
"""

import gzip
import random
import sqlite3
import struct
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce
from operator import xor
from pathlib import Path

import lz4.frame
import zstandard

Parts = list[bytes]

WHOLE = (
    0,
    1,
    2,
    3,
    7,
    8,
    9,
    15,
    16,
    255,
    256,
    65_535,
    65_536,
    2**31 - 1,
    2**31,
    2**32 - 1,
    2**40,
    2**62,
    2**63 - 1,
    2**63,
    2**64 - 1,
)
REAL = (float("nan"), float("inf"), -float("inf"), 1e308, -1e308, 5e-324, -0.0, 1e-300, 1e20, 1e9, -1.0)
WORDS = (
    b"nan", b"inf", b"-inf", b"1e309", b"5e-324", b"-0", b"9" * 20, b"-" + b"9" * 19, b"", b" ", b"0x10", b"1_000", b"1,5", b"\xef\xbc\x91",
    b"--1", b"1.", b".5", b"true", b"null", b"#", b'"', b'""', b"'", b"\x00", b"1" * 400, b"1e5000", b"2024-13-45T99:99:99", b"[]", b"{}",
    b"1970-01-01T00:00:00Z", b"9999-12-31T23:59:59.999999999Z", b"0001-01-01", b"\x1b[2J", b"\xe2\x80\xae", b"[" * 3000, b'{"x":' * 200,
)  # fmt: skip
FIELDS = (
    b"float64[999999] x\n", b"float64[] x\n", b"string s\n" * 70, b"wstring s\n", b"Self x\n", b"Nope x\n", b"float64[-1] x\n", b"float64[0] x\n",
    b"geometry_msgs/Vector3[64] v\n", b"geometry_msgs/Vector3[] v\n", b"int8 angular_velocity\n", b"===\nMSG: a/B\n", b"\xff\xfe", b"# x\n",
    b"uint64 x=5\n", b"bool[7] b\n", b"\x00", b"float z;", b"uint8_t[9999] q;", b"sensor_gyro g;", b"sensor_combined[99] self;", b";;;",
)  # fmt: skip


@dataclass(frozen=True)
class Container:
    """How a log is taken to pieces and put together; ``spoil``: the byte of a part that a checksum protects, counted from its end."""

    apart: Callable[[bytes], Parts]
    together: Callable[[Parts], bytes]
    spoil: Callable[[bytes], bytes] | None = None


def changed(rng: random.Random, part: bytes) -> bytes:
    """Return a part with some of its bytes changed, its length too."""
    data = bytearray(part)
    for _ in range(rng.choice((1, 1, 1, 2, 5))):
        at = rng.randrange(len(data) + 1)
        width = rng.choice((1, 2, 4, 8))
        kind = rng.choice(("flip", "whole", "whole", "real", "cut", "longer", "zeros", "word", "field", "without"))
        if kind == "flip" and at < len(data):
            data[at] ^= 1 << rng.randrange(8)
        elif kind == "whole":
            number = rng.choice((*WHOLE, len(data), rng.getrandbits(64))) & ((1 << 8 * width) - 1)
            data[at : at + width] = number.to_bytes(width, rng.choice(("little", "big")))
        elif kind == "real":
            data[at : at + 8] = struct.pack("<d", rng.choice(REAL))
        elif kind == "cut":
            del data[at:]
        elif kind == "longer":
            data += rng.randbytes(rng.choice((1, 7, 64, 1000)))
        elif kind == "zeros":
            data[at : at + rng.choice((4, 64))] = bytes(rng.choice((4, 64)))
        elif kind in ("word", "field"):
            data[at:at] = rng.choice(WORDS if kind == "word" else FIELDS)
        elif kind == "without":
            del data[at : at + rng.choice((1, 8, 64))]
    return bytes(data)


def rearranged(rng: random.Random, parts: Parts) -> Parts:
    """Return parts of which one is changed, lost, repeated or elsewhere."""
    parts = list(parts)
    kind = rng.choice(("change", "change", "change", "change", "lose", "repeat", "swap", "join", "shuffle"))
    at, other = rng.randrange(len(parts)), rng.randrange(len(parts))
    if rng.random() < 0.4:  # definitions are at the beginning
        at = rng.randrange(min(len(parts), 8))
    if kind == "change":
        for i in {at, *(rng.randrange(len(parts)) for _ in range(rng.choice((0, 0, 3))))}:
            parts[i] = changed(rng, parts[i])
    elif kind == "lose":
        del parts[at]
    elif kind == "repeat":
        parts[at:at] = [parts[other]] * rng.choice((1, 2, 40))
    elif kind == "swap":
        parts[at], parts[other] = parts[other], parts[at]
    elif kind == "join":
        parts[at] += parts[other]
    else:
        rng.shuffle(parts)
    return parts


# MCAP: a part is the content of a record after its kind; those in chunks stand for themselves, after the mark of their chunk

_MAGIC, _CHUNK, _IN = b"\x89MCAP0\r\n", 6, b"\xff"


def _records(data: bytes) -> Parts:
    at, found = 0, []
    while at + 9 <= len(data):
        size = int.from_bytes(data[at + 1 : at + 9], "little")
        found.append(data[at : at + 1] + data[at + 9 : at + 9 + size])
        at += 9 + size
    return found


def _joined(parts: Parts) -> bytes:
    return b"".join(part[:1] + len(part[1:]).to_bytes(8, "little") + part[1:] for part in parts if part)


def _mcap_apart(data: bytes) -> Parts:
    parts = []
    for part in _records(data[8:-8]):
        if part[0] != _CHUNK:
            parts.append(part)
            continue
        size = int.from_bytes(part[29:33], "little")
        name, packed = part[33 : 33 + size], part[33 + size + 8 :]
        head = _IN + part[1:17] + bytes([size]) + name
        content = zstandard.decompress(packed) if name == b"zstd" else lz4.frame.decompress(packed) if name else packed
        parts += [head, *(_IN + inner for inner in _records(content)), _IN]
    return parts


def _mcap_together(parts: Parts) -> bytes:
    whole, inner, head = [], None, b""
    for part in parts:
        if part[:1] != _IN:
            whole.append(part)
        elif inner is None:
            inner, head = [], part
        elif len(part) > 1:
            inner.append(part[1:])
        else:
            whole.append(_mcap_chunk(head, _joined(inner)))
            inner = None
    if inner:
        whole.append(_mcap_chunk(head, _joined(inner)))
    return _MAGIC + _joined(whole) + _MAGIC


def _mcap_chunk(head: bytes, content: bytes) -> bytes:
    name = head[18 : 18 + (head[17] if len(head) > 17 else 0)]
    packed = (
        zstandard.compress(content) if name == b"zstd" else lz4.frame.compress(content) if name == b"lz4" else content
    )
    fields = head[1:17].ljust(16, b"\0") + struct.pack("<QI", len(content), zlib.crc32(content))
    return bytes([_CHUNK]) + fields + struct.pack("<I", len(name)) + name + struct.pack("<Q", len(packed)) + packed


# ROS 1 bags: a part is the header's length, the header, and the data; chunks are not opened again


def _bag_apart(data: bytes) -> Parts:
    at, found = 13, []
    while at + 8 <= len(data):
        header = int.from_bytes(data[at : at + 4], "little")
        size = int.from_bytes(data[at + 4 + header : at + 8 + header], "little")
        found.append(data[at : at + 4 + header] + data[at + 8 + header : at + 8 + header + size])
        at += 8 + header + size
    return found


def _bag_together(parts: Parts) -> bytes:
    whole = b"#ROSBAG V2.0\n"
    for part in parts:
        header = min(int.from_bytes(part[:4], "little"), max(len(part) - 4, 0))
        data = part[4 + header :]
        whole += struct.pack("<I", header) + part[4 : 4 + header] + struct.pack("<I", len(data)) + data
    return whole


# PX4: a part is the kind of a message and its content


def _ulog_apart(data: bytes) -> Parts:
    at, found = 16, [data[:16]]
    while at + 3 <= len(data):
        size = int.from_bytes(data[at : at + 2], "little")
        found.append(data[at + 2 : at + 3 + size])
        at += 3 + size
    return found


def _ulog_together(parts: Parts) -> bytes:
    framed = (struct.pack("<H", min(len(p) - 1, 65_535)) + p[:65_536] for p in parts[1:] if p)
    return parts[0] + b"".join(framed)


# DataFlash: a part is a record; sizes are those that the log describes


def _dataflash_apart(data: bytes) -> Parts:
    sizes, at, found = {128: 89}, 0, []
    while at + 3 <= len(data) and data[at + 2] in sizes:
        size = sizes[data[at + 2]]
        if data[at + 2] == 128:
            sizes[data[at + 3]] = data[at + 4]
        found.append(data[at : at + size])
        at += size
    return found


# MAVLink: a part is the recorder's time, and a frame without its checksum


def _x25(data: bytes) -> int:
    crc = 0xFFFF
    for byte in data:
        low = byte ^ (crc & 0xFF)
        low = (low ^ (low << 4)) & 0xFF
        crc = (crc >> 8) ^ (low << 8) ^ (low << 3) ^ (low >> 4)
    return crc & 0xFFFF


def _tlog_apart(data: bytes) -> Parts:
    at, found = 0, []
    while at + 20 <= len(data):
        size = 8 + (10 if data[at + 8] == 0xFD else 6) + data[at + 9]
        found.append(data[at : at + size])
        at += size + 2
    return found


def _tlog_frame(part: bytes) -> bytes:
    from imuwb.readers.flight.mavlink_seeds import SEEDS

    if len(part) < 18:
        return part
    head = 10 if part[8] == 0xFD else 6
    body = bytearray(part[8 : 8 + head + 255])
    body[1] = max(min(len(body) - head, 255), 0)
    number = int.from_bytes(body[7:10], "little") if head == 10 else body[5]
    seed = SEEDS.get(number, 0)
    check = _x25(bytes(body[1:]) + bytes([seed if isinstance(seed, int) else seed[0]]))
    return part[:8] + bytes(body) + struct.pack("<H", check)


# u-blox, NMEA, NovAtel: a part is a frame without its checksum


def _ubx_apart(data: bytes) -> Parts:
    at, found = 0, []
    while at + 8 <= len(data):
        size = int.from_bytes(data[at + 4 : at + 6], "little")
        found.append(data[at + 2 : at + 4] + data[at + 6 : at + 6 + size])
        at += 8 + size
    return found


def _ubx_frame(part: bytes) -> bytes:
    body = part[:2].ljust(2, b"\0") + struct.pack("<H", min(len(part[2:]), 65_535)) + part[2:65_537]
    first = second = 0
    for byte in body:
        first = (first + byte) % 256
        second = (second + first) % 256
    return b"\xb5\x62" + body + bytes((first, second))


def _sentence(part: bytes) -> bytes:
    return b"$" + part + b"*%02X\r\n" % reduce(xor, part, 0)


def _novatel_apart(data: bytes) -> Parts:
    at, found = 0, []
    while at + 16 <= len(data):
        long = data[at + 2] == 0x12
        size = data[at + 3] + (int.from_bytes(data[at + 8 : at + 10], "little") if long else 12)
        found.append(data[at : at + size])
        at += size + 4
    return found


def _novatel_frame(part: bytes) -> bytes:
    frame = bytearray(part)
    if len(frame) >= 12 and frame[2] == 0x13:
        frame[3] = min(len(frame) - 12, 255)
    return bytes(frame) + struct.pack("<I", zlib.crc32(bytes(frame), 0xFFFFFFFF) ^ 0xFFFFFFFF)


def _lines(data: bytes) -> Parts:
    return data.split(b"\n")


def _flipped(place: int) -> Callable[[bytes], bytes]:
    def flip(frame: bytes) -> bytes:
        return frame[:place] + bytes([frame[place] ^ 4]) + frame[place + 1 :] if place else frame

    return flip


_TEXT = Container(_lines, b"\n".join)
CONTAINERS = {
    ".mcap": Container(_mcap_apart, _mcap_together),
    ".bag": Container(_bag_apart, _bag_together),
    ".ulg": Container(_ulog_apart, _ulog_together),
    "flight.bin": Container(_dataflash_apart, b"".join),
    ".tlog": Container(_tlog_apart, lambda parts: b"".join(map(_tlog_frame, parts)), _flipped(-9)),
    ".ubx": Container(_ubx_apart, lambda parts: b"".join(map(_ubx_frame, parts)), _flipped(30)),
    ".nmea": Container(
        lambda data: [line[1:].rpartition(b"*")[0] for line in data.split(b"\r\n") if line],
        lambda parts: b"".join(map(_sentence, parts)),
        _flipped(20),
    ),
    ".gps": Container(_novatel_apart, lambda parts: b"".join(map(_novatel_frame, parts)), _flipped(-9)),
    ".csv": _TEXT,
    ".log": _TEXT,
    ".pos": _TEXT,
    ".toml": _TEXT,
    ".gz": Container(
        lambda data: gzip.decompress(data).split(b"\n"), lambda parts: gzip.compress(b"\n".join(parts), 1, mtime=0)
    ),
    "packed.csv": Container(
        lambda data: zstandard.decompress(data).split(b"\n"), lambda parts: zstandard.compress(b"\n".join(parts))
    ),
}


def container_of(name: str) -> Container | None:
    """Return how a log of some name is taken to pieces; None for those of libraries."""
    return CONTAINERS.get(name) or CONTAINERS.get(Path(name).suffix)


def _cells(rng: random.Random, line: bytes) -> bytes:
    """Return a line of text with one of its cells replaced."""
    mark = next((m for m in (b",", b" ", b"=") if m in line), b",")
    cells = line.split(mark)
    cells[rng.randrange(len(cells))] = rng.choice(WORDS)
    return mark.join(cells)


def damaged(name: str, data: bytes, rng: random.Random) -> bytes:
    """Return a damaged log."""
    if name.endswith(".db3") and rng.random() < 0.7:
        return _database(data, rng)
    container = container_of(name)
    if container is None or rng.random() < 0.25:
        return changed(rng, data)
    parts = container.apart(data)
    if container is _TEXT and rng.random() < 0.6:
        at = rng.randrange(len(parts))
        parts[at] = _cells(rng, parts[at])
        return container.together(parts)
    return container.together(rearranged(rng, parts))


def spoilt(name: str, data: bytes, rng: random.Random) -> bytes | None:
    """Return a log of which one part does not fit its checksum; None for a format without checksums."""
    container = container_of(name)
    if name in ("zstd.mcap", "lz4.mcap"):
        return _mcap_spoilt(data, rng)
    if container is None or container.spoil is None:
        return None
    parts = container.apart(data)
    at = rng.randrange(len(parts))
    before, own, after = (container.together(some) for some in (parts[:at], parts[at : at + 1], parts[at + 1 :]))
    return before + container.spoil(own) + after


def _mcap_spoilt(data: bytes, rng: random.Random) -> bytes:
    """Return an MCAP of which a message in a chunk is changed after the checksum of the chunk was made."""
    records = _records(data[8:-8])
    at = rng.choice([i for i, part in enumerate(records) if part[0] == _CHUNK])
    parts = _mcap_apart(_MAGIC + _joined([records[at]]) + _MAGIC)
    i = rng.choice([i for i, part in enumerate(parts) if part[1:2] == b"\x05"])
    parts[i] = parts[i][:230] + bytes([parts[i][230] ^ 4]) + parts[i][231:]
    chunk = _records(_mcap_together(parts)[8:-8])[0]
    records[at] = chunk[:25] + records[at][25:29] + chunk[29:]
    return _MAGIC + _joined(records) + _MAGIC


def _database(data: bytes, rng: random.Random) -> bytes:
    """Return a recording in SQLite with other values, types, or tables."""
    base = sqlite3.connect(":memory:")
    base.deserialize(data)
    odd = rng.choice((0, -1, 2**63 - 1, -(2**63), 1.5, 1e300, "x", "\x1b[31m", b"\xff\xfe", b"", None, "a" * 3000))
    some, each = (1, 3, 7), rng.random() < 0.6
    columns = ("messages.timestamp", "messages.data", "messages.topic_id", "topics.type", "topics.serialization_format", "topics.name",
               "message_definitions.encoded_message_definition")  # fmt: skip
    table, column = rng.choice(columns).split(".")
    update = f"UPDATE OR IGNORE {table} SET {column} = ? WHERE id % {rng.choice(some)} = 0"
    scripts = (
        "ALTER TABLE messages RENAME TO m; CREATE VIEW messages AS SELECT * FROM m UNION ALL SELECT 1, 1, 2, zeroblob(9000000)",
        "ALTER TABLE topics RENAME TO m; CREATE VIEW topics AS SELECT 1 AS id, 'x' AS name, 'y' AS type, 'cdr' AS serialization_format",
        "DROP TABLE topics", "DROP INDEX timestamp_idx", "ALTER TABLE messages ADD COLUMN more GENERATED ALWAYS AS (hex(data))",
        "DELETE FROM messages", "INSERT INTO messages SELECT id + 1000, topic_id, timestamp, zeroblob(100000) FROM messages",
    )  # fmt: skip
    try:
        if each:
            base.execute(update, (odd,))
        else:
            base.executescript(rng.choice(scripts))
        base.commit()
    except (sqlite3.Error, OverflowError):
        pass
    content = base.serialize()
    base.close()
    return changed(rng, content) if rng.random() < 0.2 else content

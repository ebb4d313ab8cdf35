"""Damage to logs that knows their structure: one part is changed, and lengths and checksums around it are made right again.

A log is a list of parts: records, messages, frames, sentences or lines. ``apart`` takes a log to pieces, and ``together`` makes a log of
them, with right lengths, checksums and packing. ``damaged`` changes parts, or the bytes of the file as they are. ``spoilt`` changes a part
and leaves its checksum as it was, so that a reader must not use it.
"""

import random
import sqlite3
import struct

from tests.fuzz.containers import (
    CHUNK,
    MAGIC,
    TEXT,
    Parts,
    container_of,
    joined_records,
    mcap_apart,
    mcap_together,
    records_of,
)

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
    if container is TEXT and rng.random() < 0.6:
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
    records = records_of(data[8:-8])
    at = rng.choice([i for i, part in enumerate(records) if part[0] == CHUNK])
    parts = mcap_apart(MAGIC + joined_records([records[at]]) + MAGIC)
    i = rng.choice([i for i, part in enumerate(parts) if part[1:2] == b"\x05"])
    parts[i] = parts[i][:230] + bytes([parts[i][230] ^ 4]) + parts[i][231:]
    chunk = records_of(mcap_together(parts)[8:-8])[0]
    records[at] = chunk[:25] + records[at][25:29] + chunk[29:]
    return MAGIC + joined_records(records) + MAGIC


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

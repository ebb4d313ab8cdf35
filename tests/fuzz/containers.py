"""Logs taken to pieces, and put together with right lengths, checksums and packing; no code is that of the readers."""

import gzip
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


@dataclass(frozen=True)
class Container:
    """How a log is taken to pieces and put together; ``spoil``: the byte of a part that a checksum protects, counted from its end."""

    apart: Callable[[bytes], Parts]
    together: Callable[[Parts], bytes]
    spoil: Callable[[bytes], bytes] | None = None


# MCAP: a part is the content of a record after its kind; those in chunks stand for themselves, after the mark of their chunk

MAGIC, CHUNK, _IN = b"\x89MCAP0\r\n", 6, b"\xff"


def records_of(data: bytes) -> Parts:
    at, found = 0, []
    while at + 9 <= len(data):
        size = int.from_bytes(data[at + 1 : at + 9], "little")
        found.append(data[at : at + 1] + data[at + 9 : at + 9 + size])
        at += 9 + size
    return found


def joined_records(parts: Parts) -> bytes:
    return b"".join(part[:1] + len(part[1:]).to_bytes(8, "little") + part[1:] for part in parts if part)


def mcap_apart(data: bytes) -> Parts:
    parts = []
    for part in records_of(data[8:-8]):
        if part[0] != CHUNK:
            parts.append(part)
            continue
        size = int.from_bytes(part[29:33], "little")
        name, packed = part[33 : 33 + size], part[33 + size + 8 :]
        head = _IN + part[1:17] + bytes([size]) + name
        content = zstandard.decompress(packed) if name == b"zstd" else lz4.frame.decompress(packed) if name else packed
        parts += [head, *(_IN + inner for inner in records_of(content)), _IN]
    return parts


def mcap_together(parts: Parts) -> bytes:
    whole, inner, head = [], None, b""
    for part in parts:
        if part[:1] != _IN:
            whole.append(part)
        elif inner is None:
            inner, head = [], part
        elif len(part) > 1:
            inner.append(part[1:])
        else:
            whole.append(_mcap_chunk(head, joined_records(inner)))
            inner = None
    if inner:
        whole.append(_mcap_chunk(head, joined_records(inner)))
    return MAGIC + joined_records(whole) + MAGIC


def _mcap_chunk(head: bytes, content: bytes) -> bytes:
    name = head[18 : 18 + (head[17] if len(head) > 17 else 0)]
    packed = (
        zstandard.compress(content) if name == b"zstd" else lz4.frame.compress(content) if name == b"lz4" else content
    )
    fields = head[1:17].ljust(16, b"\0") + struct.pack("<QI", len(content), zlib.crc32(content))
    return bytes([CHUNK]) + fields + struct.pack("<I", len(name)) + name + struct.pack("<Q", len(packed)) + packed


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


TEXT = Container(_lines, b"\n".join)
CONTAINERS = {
    ".mcap": Container(mcap_apart, mcap_together),
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
    ".csv": TEXT,
    ".log": TEXT,
    ".pos": TEXT,
    ".toml": TEXT,
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

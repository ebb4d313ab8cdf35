"""UBX frames for tests, packed from their documented fields."""

import struct
from datetime import UTC, datetime, timedelta
from functools import reduce
from operator import xor

START = datetime(
    2026, 3, 7, 23, 59, 58, tzinfo=UTC
)  #: a Saturday: the GPS week ends 16 s before, leap seconds included
LEAP = 18
GPS = datetime(1980, 1, 6, tzinfo=UTC)
UNIX = datetime(1970, 1, 1, tzinfo=UTC)


def frame(kind, payload):
    """Return a frame with its checksum, summed byte by byte as the manual says."""
    body = bytes((kind >> 8, kind & 255)) + struct.pack("<H", len(payload)) + payload
    first = second = 0
    for byte in body:
        first = (first + byte) % 256
        second = (second + first) % 256
    return b"\xb5\x62" + body + bytes((first, second))


def utc(i, step=timedelta(milliseconds=250)):
    return START + i * step


def ns(when):
    since = when - UNIX
    return (since.days * 86400 + since.seconds) * 10**9 + since.microseconds * 1000


def tow(when):
    """Return the time of the GPS week in ms."""
    since = when + timedelta(seconds=LEAP) - GPS
    return round((since - timedelta(weeks=since // timedelta(weeks=1))).total_seconds() * 1000)


def put(size, *fields):
    payload = bytearray(size)
    for offset, kind, *values in fields:
        struct.pack_into(f"<{kind}", payload, offset, *values)
    return bytes(payload)


def pvt(when, *, nano=0, fix=3, flags=1, valid=7, flags3=0, place=(473_977_420, 85_455_940, 488_000), velocity=(1000, -2000, 30),
        sigmas=(14, 25, 60)):  # fmt: skip
    """Return NAV-PVT; nano: ns after the ms of ``when``."""
    second = when.replace(microsecond=0)
    rest = (when - second).microseconds * 1000 + nano
    return frame(0x0107, put(
        92, (0, "I", tow(when)), (4, "HBBBBBB", when.year, when.month, when.day, when.hour, when.minute, when.second, valid),
        (12, "I", 30), (16, "i", rest), (20, "BB", fix, flags), (24, "ii", place[1], place[0]), (32, "ii", place[2], place[2] - 47_000),
        (40, "II", *sigmas[:2]), (48, "iii", *velocity), (68, "I", sigmas[2]), (78, "H", flags3),
    ))  # fmt: skip


def fine(when, *, place=(473_977_420, 85_455_940, 488_000), rest=(12, -34, 5), sigmas=(123, 456), flags=0):
    return frame(0x0114, put(
        36, (3, "B", flags), (4, "I", tow(when)), (8, "iii", place[1], place[0], place[2]), (24, "bbb", rest[1], rest[0], rest[2]),
        (28, "II", *sigmas),
    ))  # fmt: skip


def covariance(when, position=(4.0, 0.1, 0.2, 9.0, 0.3, 16.0), velocity=(0.01, 0, 0, 0.04, 0, 0.09), valid=(1, 1)):
    return frame(0x0136, put(64, (0, "I", tow(when)), (5, "BB", *valid), (16, "6f", *position), (40, "6f", *velocity)))


def velned(when, velocity=(100, -200, 3), sigma=7):
    return frame(0x0112, put(36, (0, "I", tow(when)), (4, "iii", *velocity), (28, "I", sigma)))


def posllh(when, place=(473_977_420, 85_455_940, 488_000), sigmas=(14, 25)):
    return frame(0x0102, put(28, (0, "I", tow(when)), (4, "iii", place[1], place[0], place[2]), (20, "II", *sigmas)))


def status(when, fix=3, flags=1):
    return frame(0x0103, put(16, (0, "I", tow(when)), (4, "BB", fix, flags)))


def time_gps(when, rest=0):
    week = (when + timedelta(seconds=LEAP) - GPS) // timedelta(weeks=1)
    return frame(0x0120, put(16, (0, "I", tow(when)), (4, "i", rest), (8, "h", week), (10, "bB", LEAP, 7)))


def measured(tag, values, *, source=0, calibrated=None):
    """Return ESF-MEAS of {type: number}; a bit that has no meaning is set."""
    flags = (len(values) << 11) | (8 if calibrated is not None else 0)
    words = [((kind & 63 | 64) << 24) | (number & 0xFFFFFF) for kind, number in values.items()]
    tail = b"" if calibrated is None else struct.pack("<I", calibrated)
    return frame(
        0x1002, struct.pack("<IHH", tag % 2**32, flags, source) + struct.pack(f"<{len(words)}I", *words) + tail
    )


def raw(*samples):
    """Return ESF-RAW of samples (tag, {type: number})."""
    parts = [
        struct.pack("<II", (kind << 24) | (number & 0xFFFFFF), tag)
        for tag, values in samples
        for kind, number in values.items()
    ]
    return frame(0x1003, bytes(4) + b"".join(parts))


def sentence(body):
    return f"${body}*{reduce(xor, body.encode(), 0):02X}\r\n".encode()


def solution(when, fix=3, flags=0x0F, rest=0):
    week = (when + timedelta(seconds=LEAP) - GPS) // timedelta(weeks=1)
    return frame(0x0106, put(52, (0, "I", tow(when)), (4, "i", rest), (8, "h", week), (10, "BB", fix, flags)))

"""MAVLink frames of a telemetry log, found and checked without a Python step per frame.

A telemetry log is a series of frames of both protocol versions; before each frame are eight bytes with the recorder's time.
Bytes that are no frame, and frames with a wrong checksum, are skipped.

Specification: https://mavlink.io/en/guide/serialization.html
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from imuwb.arrays import Bytes, Integers
from imuwb.compiled import compiled
from imuwb.readers.flight.mavlink_seeds import SEEDS

STAMP = 8  #: bytes of the recorder's time, big-endian µs since 1970
FIRST, SECOND_VERSION = 0xFE, 0xFD
SIGNED = 0x01  #: incompatibility flag: 13 bytes of signature after the checksum
MOST = 3  #: largest number of seeds for one message number
_TABLE = 1 << 16  #: no public message has a larger number


def _seeds() -> NDArray[np.int16]:
    table = np.full((_TABLE, MOST), -1, np.int16)
    for number, seeds in SEEDS.items():
        for k, seed in enumerate((seeds,) if isinstance(seeds, int) else seeds):
            table[number, k] = seed
    return table


def _steps() -> NDArray[np.uint16]:
    """Return the table of CRC-16/MCRF4XX for a byte."""
    table = np.arange(256, dtype=np.uint16)
    for _ in range(8):
        table = np.where(table & 1, (table >> 1) ^ 0x8408, table >> 1).astype(np.uint16)
    return table


_SEEDS, _STEPS = _seeds(), _steps()


@dataclass(frozen=True, eq=False, slots=True)
class Frames:
    """The frames of a buffer whose checksum is correct, and counts of the rest."""

    number: Integers  #: (n,) number of the message
    system: Integers  #: (n,)
    component: Integers  #: (n,)
    record: Integers  #: (n,) offset of the recorder's time
    payload: Integers  #: (n,) offset
    length: Integers  #: (n,) of the payload; trailing zeros are not sent
    failed: int  #: frames whose checksum is wrong
    unknown: int  #: frames of messages in no public dialect: they cannot be checked, and are not used
    skipped: int  #: bytes that belong to no frame
    end: int  #: offset after the last whole frame


@compiled()
def _span(buffer: Bytes, frame: int) -> tuple[int, int]:  # pragma: no cover - compiled
    """Return the ends of a frame's payload and of the frame."""
    end = frame + (6 if buffer[frame] == FIRST else 10) + int(buffer[frame + 1])
    signed = buffer[frame] == SECOND_VERSION and buffer[frame + 2] & SIGNED
    return end, end + (15 if signed else 2)


@compiled()
def _number(buffer: Bytes, frame: int) -> int:  # pragma: no cover - compiled
    if buffer[frame] == FIRST:
        return int(buffer[frame + 5])
    return int(buffer[frame + 7]) | int(buffer[frame + 8]) << 8 | int(buffer[frame + 9]) << 16


@compiled()
def _holds(
    buffer: Bytes, frame: int, end: int, seeds: NDArray[np.int16], steps: NDArray[np.uint16]
) -> bool:  # pragma: no cover - compiled
    """Return whether the checksum after a payload is correct for one of the message's seeds."""
    crc = np.uint16(0xFFFF)
    for k in range(frame + 1, end):
        crc = np.uint16(crc >> 8) ^ steps[np.uint8(crc) ^ buffer[k]]
    for seed in seeds:
        if seed >= 0:
            seeded = np.uint16(crc >> 8) ^ steps[np.uint8(crc) ^ np.uint8(seed)]
            if np.uint8(seeded) == buffer[end] and np.uint8(seeded >> 8) == buffer[end + 1]:
                return True
    return False


@compiled()
def _begins(buffer: Bytes, record: int) -> bool:  # pragma: no cover - compiled
    """Return whether a record may begin here; the end of the buffer counts as a beginning."""
    frame = record + STAMP
    return record == buffer.size or (frame < buffer.size and FIRST >= buffer[frame] >= SECOND_VERSION)


@compiled()
def _scan(
    buffer: Bytes,
    last: bool,  # noqa: FBT001 - compiled code is called by place
    seeds: NDArray[np.int16],
    steps: NDArray[np.uint16],
    frames: Integers,
    counts: Integers,
) -> tuple[int, int]:  # pragma: no cover - compiled
    """Fill the table, (6, room); return the number of frames, and where the search ended."""
    n, at = 0, 0
    none = np.full(1, -1, np.int16)
    while at + STAMP + 12 <= buffer.size + 4 * last and n < frames.shape[1]:
        frame = at + STAMP
        if not _begins(buffer, at) or (buffer[frame] == SECOND_VERSION and frame + 12 > buffer.size):
            counts[2] += 1
            at += 1
            continue
        end, after = _span(buffer, frame)
        if after > buffer.size:
            if not last:
                break
            counts[2] += 1  # no bytes follow that could complete it, but another frame may begin within it
            at += 1
            continue
        number = _number(buffer, frame)
        # A frame with an unknown flag must not be read.
        understood = buffer[frame] == FIRST or buffer[frame + 2] <= SIGNED
        known = understood and number < seeds.shape[0] and seeds[number, 0] >= 0
        if _holds(buffer, frame, end, seeds[number] if known else none, steps):
            place = 3 if buffer[frame] == FIRST else 5
            frames[0, n], frames[1, n], frames[2, n] = number, buffer[frame + place], buffer[frame + place + 1]
            frames[3, n], frames[5, n] = at, buffer[frame + 1]
            frames[4, n] = end - frames[5, n]
            n += 1
            at = after
        elif after + STAMP >= buffer.size and not last:
            break  # the next bytes show whether this is a frame
        elif _begins(buffer, after):
            counts[0 if known else 1] += 1
            at = after
        else:
            counts[2] += 1
            at += 1
    return n, at


def scan(buffer: Bytes, *, last: bool) -> Frames:
    """Return the frames of a buffer; ``last`` means that no buffer follows."""
    tables: list[Integers] = []
    counts, end = np.zeros(3, np.int64), 0
    while True:
        table = np.empty((6, max((buffer.size - end) // 24, 1)), np.int64)
        n, step = _scan(buffer[end:], last, _SEEDS, _STEPS, table, counts)
        table[3:5, :n] += end
        tables.append(table[:, :n])
        end += step
        if n < table.shape[1]:
            break
    number, system, component, record, payload, length = np.concatenate(tables, axis=1)
    failed, unknown, skipped = (int(count) for count in counts)
    return Frames(number, system, component, record, payload, length, failed, unknown, skipped, end)

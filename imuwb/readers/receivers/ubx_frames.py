"""Frames of the UBX protocol, found and checked without a Python step per frame.

A frame is ``B5 62``, class, number, length (2 bytes), payload, and a checksum of 2 bytes (8-bit Fletcher). Source: u-blox F9 HPS
1.30 interface description (UBX-22010984), section "UBX frame structure".
"""

from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Booleans, Bytes, Integers

AROUND = 8  #: bytes of a frame besides its payload
PAYLOAD = 6  #: bytes before the payload


@dataclass(frozen=True, eq=False, slots=True)
class Frames:
    """The frames of a buffer whose checksum is correct."""

    start: Integers  #: (n,) offset of each, rising
    kind: Integers  #: (n,) 256 times the class, plus the number
    length: Integers  #: (n,) of the payload
    failed: int  #: frames whose checksum is wrong
    end: int  #: offset after which a frame may be incomplete

    @property
    def payload(self) -> Integers:
        """Offsets of the payloads."""
        return self.start + PAYLOAD


def scan(buffer: Bytes, *, last: bool) -> Frames:
    """Return the frames of a buffer; ``last`` means that no buffer follows."""
    at = np.flatnonzero((buffer[:-1] == 0xB5) & (buffer[1:] == 0x62))  # noqa: PLR2004 - the two sync bytes
    headed = at[at + AROUND <= buffer.size]
    length = buffer[headed + 4] + 256 * buffer[headed + 5].astype(np.int64)
    after = headed + AROUND + length
    whole = after <= buffer.size
    sound = np.zeros(headed.size, dtype=bool)
    sound[whole] = _holds(buffer, headed[whole], after[whole])
    kept = np.flatnonzero(sound)
    kept = kept[_apart(headed[kept], after[kept])]
    end = buffer.size
    if not last:
        unsure = np.concatenate([headed[~whole], at[headed.size :], [buffer.size - 1] if buffer[-1:] == 0xB5 else []])  # noqa: PLR2004
        outside = unsure[~_inside(unsure, headed[kept], after[kept])]
        end = int(outside.min()) if outside.size else end
        kept = kept[headed[kept] < end]
    wrong = headed[~sound & (headed < end)]
    failed = int(np.count_nonzero(~_inside(wrong, headed[kept], after[kept])))
    kind = 256 * buffer[headed[kept] + 2].astype(np.int64) + buffer[headed[kept] + 3]
    return Frames(headed[kept], kind, length[kept], failed, end)


def gaps(frames: Frames) -> list[tuple[int, int]]:
    """Return (begin, end) of the bytes of a buffer that belong to no frame, up to ``frames.end``."""
    begin = np.concatenate([[0], frames.start + AROUND + frames.length])
    end = np.concatenate([frames.start, [frames.end]])
    filled = end > begin
    return list(zip(begin[filled].tolist(), end[filled].tolist(), strict=True))


def _holds(buffer: Bytes, start: Integers, after: Integers) -> Booleans:
    """Return whether the checksums of frames are correct.

    The first byte is the sum of the bytes from the class to the end of the payload, the second the sum of these sums: each byte
    times its distance from the end. With running sums both are differences, and bytes wrap as the protocol wants.
    """
    zero = np.zeros(1, np.uint8)
    place = np.arange(buffer.size, dtype=np.uint8)
    plain = np.concatenate([zero, np.cumsum(buffer, dtype=np.uint8)])
    weighted = np.concatenate([zero, np.cumsum(buffer * place, dtype=np.uint8)])
    begin, end = start + 2, after - 2
    first = plain[end] - plain[begin]
    second = end.astype(np.uint8) * first - (weighted[end] - weighted[begin])
    return (first == buffer[end]) & (second == buffer[end + 1])


def _apart(start: Integers, after: Integers) -> Booleans:
    """Return which frames are kept, so that none begins within another."""
    kept = np.ones(start.size, dtype=bool)
    if (start[1:] < after[:-1]).any():
        free = 0
        for i, (begin, end) in enumerate(zip(start.tolist(), after.tolist(), strict=True)):
            kept[i] = begin >= free
            free = end if kept[i] else free
    return kept


def _inside(at: Integers, start: Integers, after: Integers) -> Booleans:
    """Return which offsets are within a frame."""
    if not start.size:
        return np.zeros(at.size, dtype=bool)
    frame = np.searchsorted(start, at, side="right") - 1
    return (frame >= 0) & (at < after[frame])

"""The lines of a text log as sentences: tag, cells, and whether the checksum is correct."""

import re
import zlib
from dataclasses import dataclass
from functools import reduce
from operator import xor

from imuwb.readers.text.trust import is_number

_NOVATEL = re.compile(rb"[#%]([A-Z0-9]{4,})(,[^;*]*);([^*]*)\*([0-9a-fA-F]{8})\s*$")
_STAMP = re.compile(rb"\[?\s*([0-9][0-9.:TZ +-]*[0-9Z])\s*\]?[\s,;|>:]*$")
_SHORT = 3  #: cells of NovAtel's short header: name, week, time of week
_LONG = 10  #: cells of its long header: name, port, sequence, idle, status, week, time of week, ...
_ALL_ONES = 0xFFFF_FFFF


@dataclass(frozen=True, slots=True)
class Line:
    """One sentence."""

    tag: str
    cells: tuple[str, ...]  #: after the tag; NovAtel's week and time of week go before the cells of its body
    sound: bool  #: the checksum is correct, or there is none
    stamp: str = ""  #: a host's time before the sentence


def line_of(line: bytes) -> Line | None:
    """Return the sentence of a line; None for a line that has no tag."""
    text = line.strip()
    if text[:1] in b"#%" and text:
        return _novatel(text)
    at = text.find(b"$")
    if at >= 0:
        return _dollar(text, at)
    for separator in (b";", b","):
        tag, found, rest = text.partition(separator)
        if found and tag.isalnum() and not tag.isdigit():
            return Line(tag.decode("ascii", "replace"), _cells(rest, separator), sound=True)
    return None


def crc32(data: bytes) -> int:
    """Return NovAtel's checksum: the polynomial of zip, begun with 0 and not inverted at the end (OEM7 manual, 32-bit CRC)."""
    return zlib.crc32(data, _ALL_ONES) ^ _ALL_ONES


def _novatel(text: bytes) -> Line | None:
    """Return a sentence of NovAtel: ``#NAME,...,week,time,...;body*crc``, or ``%NAME,week,time;body*crc``."""
    match = _NOVATEL.match(text)
    if match is None:
        return None
    head = match[2].split(b",")
    if len(head) < _SHORT:
        return None
    week, time = (head[5], head[6]) if len(head) >= _LONG else (head[1], head[2])
    sound = crc32(text[1 : text.rindex(b"*")]) == int(match[4], 16)
    return Line(match[1].decode(), _cells(b",".join((week, time, match[3])), b","), sound)


def _dollar(text: bytes, at: int) -> Line | None:
    """Return a sentence that begins with a dollar sign, perhaps after a stamp of the host."""
    stamp = ""
    if at:
        before = _STAMP.match(text[:at])
        if before is None:
            return None
        stamp = before[1].decode()
    body, star, check = text[at:].partition(b"*")
    sound = True
    if star:
        try:
            sound = check.strip() == b"XX" or reduce(xor, body[1:], 0) == int(check.strip()[:2], 16)
        except ValueError:
            sound = False
    tag, _, rest = body.partition(b",")
    return Line(tag.decode("ascii", "replace"), _cells(rest, b","), sound, stamp if is_number(stamp) else "")


def _cells(text: bytes, separator: bytes) -> tuple[str, ...]:
    return tuple(map(str.strip, text.decode("ascii", "replace").replace('"', "").split(separator.decode())))

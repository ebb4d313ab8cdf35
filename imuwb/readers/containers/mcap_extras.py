"""Metadata and attachments of an MCAP file: what imuwb itself wrote there, and what is only named.

Specification: https://mcap.dev/spec
"""

import struct
from collections.abc import Sequence

from imuwb.log import MEAN_SEA_LEVEL
from imuwb.notes import Note
from imuwb.ros import OURS, TRUTH
from imuwb.texts import names_text

#: names of metadata that are not named: those that imuwb reads, and the copy of metadata.yaml in each file of rosbag2
READ = (OURS, TRUTH, "rosbag2")
NAMED = 6  #: entries of metadata that are named


def text(content: bytes, at: int) -> tuple[str, int]:
    """Return a text that is stored after its length, and the offset of its end.

    Raises:
        ValueError: the text is longer than its record.
    """
    size = struct.unpack_from("<I", content, at)[0]
    if at + 4 + size > len(content):
        raise ValueError(f"a text of {size} bytes is longer than its record")
    return content[at + 4 : at + 4 + size].decode("utf-8", "replace"), at + 4 + size


def metadata(content: bytes) -> tuple[str, dict[str, str]]:
    """Return a metadata record's name and entries.

    Raises:
        ValueError, struct.error: the record is damaged.
    """
    name, at = text(content, 0)
    end = at + 4 + struct.unpack_from("<I", content, at)[0]
    at, entries = at + 4, dict[str, str]()
    while at < min(end, len(content)):
        key, at = text(content, at)
        entries[key], at = text(content, at)
    return name, entries


def metadata_text(record: tuple[str, dict[str, str]]) -> str:
    """Return what a metadata record is, in a few words."""
    name, entries = record
    return f"metadata {name} ({names_text(list(entries), NAMED)})" if entries else f"metadata {name}"


def attachment(content: bytes) -> tuple[str, str, int]:
    """Return an attachment's name, type and size (bytes).

    Raises:
        ValueError, struct.error: the record is damaged.
    """
    name, at = text(content, 16)
    media_type, at = text(content, at)
    return name, media_type, struct.unpack_from("<Q", content, at)[0]


def attachment_text(name: str, media_type: str, size: int) -> str:
    """Return what an attachment is, in a few words."""
    return f"attachment {name} ({', '.join(filter(None, (media_type, f'{size} bytes')))})"


def extras_notes(extras: Sequence[str]) -> list[Note]:
    """Return the note on attachments and metadata, which imuwb does not read; no note without any."""
    names = list(dict.fromkeys(extras))
    return [Note("unused", f"not used: {names_text(names)} (no measurements)")] if names else []


def above_sea_level(record: tuple[str, dict[str, str]]) -> set[str]:
    """Return the topics whose heights are above mean sea level, according to metadata that imuwb wrote."""
    name, entries = record
    return {topic for topic, text in entries.items() if MEAN_SEA_LEVEL in text} if name == OURS else set()

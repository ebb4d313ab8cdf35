"""Refuses a packed file of a format whose library reads files in no order, and so needs the file itself."""

from pathlib import Path

from imuwb.errors import UnreadableLogError
from imuwb.readers.bytes import source


def refuse_packed(path: Path) -> None:
    """Raise UnreadableLogError for a file that is packed."""
    with source.open_unpacked(path) as file:
        if source.is_packed(file):
            raise UnreadableLogError(
                f"{path}: this file is packed, and its format is read in no order; unpack it first (gzip -d, zstd -d)"
            )

"""A packed file as a file on disk, for readers that seek."""

import shutil
import tempfile
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import cast

from imuwb.errors import UnreadableLogError
from imuwb.readers.bytes import budget, source
from imuwb.readers.bytes.source import Source


@contextmanager
def unpacked(path: Source, faults: list[str]) -> Generator[Path]:
    """Give the path of a file's unpacked content: the file itself, or a temporary file if it is in gzip or Zstandard.

    Notes on what is wrong with the packed file are added to ``faults``; the part that can be unpacked is used.

    Raises:
        UnreadableLogError: the file cannot be opened, or there is no room for its content.
    """
    with source.open_unpacked(path) as file:
        if not source.is_packed(file):
            yield cast("Path", path)
            return
        with tempfile.TemporaryDirectory(prefix="imuwb-") as folder:
            whole = Path(folder) / Path(path.name).stem
            try:
                with whole.open("wb") as content:
                    for piece in source.pieces(file, faults):
                        content.write(piece)
                        budget.check(content.tell(), "its unpacked content")
            except OSError as error:
                free = shutil.disk_usage(folder).free >> 20
                raise UnreadableLogError(
                    f"{path}: the packed file cannot be unpacked to the temporary folder, which has {free} MB free "
                    f"({error.strerror}); unpack it yourself, and read the file that it contains"
                ) from error
            yield whole

"""A remote log while it is read: its bytes by ranges as they are needed, or a copy of all of them in a temporary file."""

import hashlib
import io
import os
import shutil
import tempfile
from collections import deque
from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import BinaryIO, Self, cast

from imuwb.errors import ImuwbError, UnreadableLogError
from imuwb.notes import Note
from imuwb.progress import Progress
from imuwb.readers.bytes.address import Address

HEAD = 1 << 16  #: bytes that are asked for first, and after each jump
LARGEST = 16 << 20  #: bytes that are asked for at once
REST = 1 << 20  #: bytes after the last that a reader needs; as many are asked for, for the fingerprint of all
KEPT = 32 << 20  #: bytes of the last answers that are kept, for small steps back
BESIDE = 16 << 20  #: bytes; a larger object beside a log is no part of it
_WEB_PAGE = (b"<!doctype html", b"<html")


class RemoteLog:
    """A remote log. Its bytes come in order once, and what is read twice within ``KEPT`` bytes is asked for once.

    A jump asks for ``HEAD`` bytes, and each further step in order for twice as many, up to ``LARGEST``. A server that sends no
    parts, and a reader that needs a file, get a copy on disk, which takes as much room as the log until ``close``.

    Raises:
        UnreadableLogError: the object cannot be read; the message states why and what to do.
        UsageError: the environment does not state what the store needs.
    """

    def __init__(self, address: Address) -> None:
        """Ask for the first bytes."""
        # obstore is imported only where an address is read.
        from imuwb.readers.bytes.transfer import AbsentError, NoRangesError, Transfer  # noqa: PLC0415

        self.address = address
        self._blocks: deque[tuple[int, bytes]] = deque()
        self._next, self._ahead = 0, HEAD
        self._digest, self._hashed = hashlib.sha256(), 0
        self._copy: Path | None = None
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self.notes: list[Note] = []  #: on objects beside the log that cannot be read
        self._transfer = Transfer(address)
        try:
            self._fetch(0, HEAD)
        except NoRangesError:
            self._transfer = Transfer(address, ranged=False)
            self._copied_whole()
        except AbsentError as error:
            raise UnreadableLogError(f"{address}: {error}") from None

    def _copied_whole(self) -> None:
        """Copy the log of a server that sends no parts."""
        from imuwb.readers.bytes.transfer import AbsentError  # noqa: PLC0415 - as above

        try:
            self.copied()
        except AbsentError as error:
            self.close()
            raise UnreadableLogError(f"{self}: {error}") from None
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Self:
        """Return the log."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Remove the copy."""
        self.close()

    def __str__(self) -> str:
        """Return the address without secrets."""
        return str(self.address)

    @property
    def name(self) -> str:
        """The last part of the address."""
        return self.address.name

    @property
    def size(self) -> int:
        """The bytes of the object."""
        return self._transfer.size or 0

    @property
    def ranged(self) -> bool:
        """Whether the server sends parts of the object."""
        return self._transfer.ranged

    def open(self) -> BinaryIO:
        """Return the log as a file; the bytes come as they are read."""
        if self._copy is not None:
            return self._copy.open("rb")
        return cast("BinaryIO", io.BufferedReader(_RemoteFile(self), HEAD))

    def copied(self, beside: Sequence[str] = (), progress: Progress | None = None) -> Path:
        """Return a copy of the log on disk, and beside it copies of objects of some names, if there are such objects.

        Raises:
            UnreadableLogError: the transfer ended, or the disk has no room for the log.
        """
        if self._copy is None:
            try:
                self._copy = self._written(progress)
            except OSError as error:
                text = f"{self}: its copy cannot be written: {error.strerror or error}; set TMPDIR to another folder"
                raise UnreadableLogError(text) from None
            self._blocks.clear()
        if beside and self.address.signed:
            text = f"objects beside {self}, such as {beside[0]}, are not looked for: the query of its address is valid for it alone"
            self.notes.append(Note("beside-not-sought", text))
            return self._copy
        for name in beside:
            self._copy_beside(self._copy, name)
        return self._copy

    def _written(self, progress: Progress | None) -> Path:
        """Write the log to a file in a new folder."""
        self._folder = tempfile.TemporaryDirectory(prefix="imuwb-", ignore_cleanup_errors=True)
        copy = Path(self._folder.name) / self.address.file_name
        with copy.open("wb") as file:
            for piece in self._in_order():
                if not file.tell():
                    self._check_room(copy)
                self._hash(file.tell(), piece)
                file.write(piece)
                if progress is not None:
                    progress(file.tell(), self.size)
        return copy

    def fingerprint(self) -> str:
        """Return ``sha256:...`` of the bytes; empty if only parts of the log were read."""
        if self.size - self._hashed > REST:
            return ""
        while self._hashed < self.size:
            self._some(self._hashed, LARGEST)
        return f"sha256:{self._digest.hexdigest()}"

    def close(self) -> None:
        """Remove the copy."""
        self._blocks.clear()
        if self._folder is not None:
            self._folder.cleanup()

    @contextmanager
    def named(self) -> Generator[None]:
        """Name the address, and not the copy, in errors."""
        try:
            yield
        except ImuwbError as error:
            if self._copy is None:
                raise
            text = str(error).replace(str(self._copy), str(self))
            raise type(error)(text.replace(f"{self._copy.parent}{os.sep}", str(self.address.beside("")))) from None

    def part(self, at: int, most: int) -> bytes:
        """Return bytes from an offset on, at least one and at most ``most``; none at the end."""
        return self._some(at, most) if at < self.size else b""

    def _some(self, at: int, most: int) -> bytes:
        if self._copy is not None:
            with self._copy.open("rb") as file:
                file.seek(at)
                return file.read(most)
        for _ in range(2):
            for start, block in self._blocks:
                if start <= at < start + len(block):
                    self._hash(start, block)
                    return block[at - start : at - start + most]
            self._fetch(at, most)
        return b""

    def _fetch(self, at: int, most: int) -> None:
        """Ask for the bytes from an offset on."""
        follows = at == self._next and at > 0
        self._ahead = min(2 * self._ahead, LARGEST) if follows else HEAD
        start = at if follows or not self.size else max(0, min(at, self.size - HEAD))
        stop = at + min(max(self._ahead, most), LARGEST)
        block = b"".join(self._transfer.pieces(start, min(stop, self.size) if self.size else stop))
        self._blocks.append((start, block))
        self._next = start + len(block)
        while len(self._blocks) > 1 and sum(len(kept) for _, kept in self._blocks) > KEPT:
            self._blocks.popleft()

    def _in_order(self) -> Iterator[bytes]:
        """Yield all bytes; the first ones are there already."""
        first = self._blocks[0][1] if self._blocks and self._blocks[0][0] == 0 else b""
        if first:
            yield first
        if not self._transfer.size or len(first) < self.size:
            yield from self._transfer.pieces(len(first))

    def _hash(self, start: int, block: bytes) -> None:
        if start <= self._hashed < start + len(block):
            self._digest.update(block[self._hashed - start :])
            self._hashed = start + len(block)

    def _check_room(self, copy: Path) -> None:
        room = shutil.disk_usage(copy.parent).free
        if self.size > room:
            raise UnreadableLogError(
                f"{self}: its copy needs {self.size} bytes, and {tempfile.gettempdir()} has {room}; set TMPDIR to a folder on a "
                "larger disk, or download the log first"
            )

    def _copy_beside(self, copy: Path, name: str) -> None:
        from imuwb.readers.bytes.transfer import AbsentError, Transfer  # noqa: PLC0415 - as above

        address = self.address.beside(name)
        place = copy.with_name(address.file_name)
        if place.exists():
            return
        transfer = Transfer(address, ranged=False)
        content = bytearray()
        try:
            for piece in transfer.pieces():
                content += piece
                if (transfer.size or 0) > BESIDE:
                    self.notes.append(Note("beside-not-read", f"{address} is not read: it has {transfer.size} bytes"))
                    return
        except AbsentError as error:
            if error.denied:  # S3 also answers so where there is no object, if the user may not list the bucket
                text = f"{address} is not read: access is denied, so it may exist; if it does not, this is of no matter"
                self.notes.append(Note("beside-not-read", text))
            return
        if not is_web_page(content):  # a server may answer every address with its own page
            place.write_bytes(content)


def is_web_page(content: bytes | bytearray) -> bool:
    """Return whether an answer is HTML."""
    return content[:64].lstrip().lower().startswith(_WEB_PAGE)


class _RemoteFile(io.RawIOBase):
    """A position in a remote log."""

    def __init__(self, log: RemoteLog) -> None:
        super().__init__()
        self._log, self._at = log, 0

    def readable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def tell(self) -> int:
        return self._at

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        self._at = max(0, offset + {io.SEEK_SET: 0, io.SEEK_CUR: self._at, io.SEEK_END: self._log.size}[whence])
        return self._at

    def readinto(self, buffer: memoryview) -> int:  # pyright: ignore[reportIncompatibleMethodOverride]
        piece = self._log.part(self._at, len(buffer))
        buffer[: len(piece)] = piece
        self._at += len(piece)
        return len(piece)

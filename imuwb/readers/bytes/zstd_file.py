"""A file packed with Zstandard, unpacked as it is read."""

import io
from typing import BinaryIO

import zstandard

PIECE = 1 << 12  #: packed bytes that are unpacked at a time; a small piece may unpack to very much


class ZstdFile(io.BufferedReader):
    """The unpacked content, with the packed file, whose position tells how much is read."""

    def __init__(self, packed: BinaryIO) -> None:
        """Set the packed file, which is closed with this one."""
        super().__init__(_Unpacking(packed))
        self.packed = packed

    def close(self) -> None:
        """Close both files."""
        super().close()
        self.packed.close()


class _Unpacking(io.RawIOBase):
    def __init__(self, packed: BinaryIO) -> None:
        super().__init__()
        self._packed, self._frame, self._ready, self._rest = packed, None, memoryview(b""), b""

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: memoryview, /) -> int:  # pyright: ignore[reportIncompatibleMethodOverride]
        """Unpack some bytes; EOFError if the file ends inside a frame, OSError if a frame is damaged."""
        while not self._ready:
            piece = self._rest or self._packed.read(PIECE)
            self._rest = b""
            if not piece:
                if self._frame is not None:
                    raise EOFError("it ends inside a frame of Zstandard")
                return 0
            self._frame = self._frame or zstandard.ZstdDecompressor().decompressobj()
            try:
                self._ready = memoryview(self._frame.decompress(piece))
            except zstandard.ZstdError as error:
                raise OSError(str(error)) from error
            if self._frame.eof:  # several frames in a row are one file
                self._rest, self._frame = self._frame.unused_data, None
        count = min(len(buffer), len(self._ready))
        buffer[:count] = self._ready[:count]
        self._ready = self._ready[count:]
        return count

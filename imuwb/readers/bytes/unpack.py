"""Unpacks compressed pieces of logs, to at most their stated size, so that a small file cannot fill the memory."""

import bz2
import io

import lz4.frame
import zstandard

from imuwb.readers.bytes import budget

LARGEST = 1 << 30  #: bytes; a piece with a larger stated size is not unpacked
ZSTD_HEADER = 18  #: bytes at most
LZ4_RATIO = 256  #: bytes at most that a byte of lz4 unpacks to
PIECE = "a packed piece of the log"
_FAULTS = (zstandard.ZstdError, RuntimeError, EOFError, OSError)


def unpack(packed: memoryview, compression: str, size: int) -> bytes | memoryview:
    """Return the content of a packed piece.

    Args:
        packed: the piece.
        compression: ``zstd``, ``lz4``, ``bz2``, ``none`` or an empty text.
        size: its stated size (bytes) when unpacked.

    Raises:
        ValueError: the piece cannot be used; the message states why.
        OverBudgetError: its content takes more memory than the log may.
    """
    if size > LARGEST:
        raise ValueError(f"its stated size of {size} bytes is above the limit of {LARGEST}")
    try:
        _check_size(packed, compression, size)
        unpacked = _unpacked(packed, compression, size)
    except _FAULTS as error:
        raise ValueError(f"{compression} cannot unpack it ({error})") from error
    if len(unpacked) != size:
        raise ValueError(f"it unpacks to {len(unpacked)} bytes, but {size} are stated")
    return unpacked


def _check_size(packed: memoryview, compression: str, size: int) -> None:
    """Raise ValueError if the packed piece shows that the stated size is wrong; then compare the size with the budget."""
    if compression == "zstd":
        # The library would allocate the size that the frame states, even if it is very large.
        if zstandard.frame_content_size(bytes(packed[:ZSTD_HEADER])) not in (-1, size):
            raise ValueError("its zstd frame and its header state different sizes")
    elif compression == "lz4" and size > LZ4_RATIO * len(packed):
        raise ValueError(f"it unpacks to {LZ4_RATIO * len(packed)} bytes at most, but {size} are stated")
    elif compression in ("", "none") and size != len(packed):
        raise ValueError(f"it unpacks to {len(packed)} bytes, but {size} are stated")
    budget.check(size, PIECE)


def _unpacked(packed: memoryview, compression: str, size: int) -> bytes | memoryview:
    if compression in ("", "none"):
        return packed
    if compression == "zstd":
        return zstandard.ZstdDecompressor().decompress(packed, max_output_size=size)
    if compression == "lz4":
        return lz4.frame.LZ4FrameDecompressor().decompress(packed, max_length=size + 1)
    if compression == "bz2":
        return bz2.BZ2Decompressor().decompress(packed, max_length=size + 1)
    raise ValueError(f"its compression {compression!r} is not supported; zstd, lz4, bz2 and none are")


def unpack_front(packed: memoryview, compression: str, size: int) -> bytes:
    """Return the part of a cut piece that can be unpacked; it may be empty.

    Raises:
        OverBudgetError: this part takes more memory than the log may.
    """
    if size > LARGEST:
        return b""
    try:
        if compression == "zstd":
            return _zstd_front(packed, size)
        most = min(size, LZ4_RATIO * len(packed)) if compression == "lz4" else size
        budget.check(min(most, len(packed)) if compression in ("", "none") else most, PIECE)
        return bytes(_unpacked(packed, compression, most))[:size]
    except (*_FAULTS, ValueError):
        return b""


def _zstd_front(packed: memoryview, size: int) -> bytes:
    """Return what a frame unpacks to up to its cut; nothing if this is more than its stated size."""
    pieces = bytearray()
    with zstandard.ZstdDecompressor().stream_reader(io.BytesIO(packed)) as reader:
        while len(pieces) <= size:
            try:
                piece = reader.read(1 << 20)
            except zstandard.ZstdError:  # damage; what is before it counts
                break
            if not piece:
                break
            pieces += piece
            budget.check(len(pieces), PIECE)
    return bytes(pieces) if len(pieces) <= size else b""

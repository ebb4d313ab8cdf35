"""Unpacks compressed pieces of logs within the size that they state: a small file must not fill the memory."""

from __future__ import annotations

import bz2

import lz4.frame
import zstandard

LARGEST = 1 << 30  #: bytes; a piece that claims to unpack to more is not unpacked


def unpack(packed: memoryview, compression: str, size: int) -> bytes | memoryview:
    """Return what a piece unpacks to.

    Args:
        packed: the piece.
        compression: ``zstd``, ``lz4``, ``bz2``, or ``none`` or nothing.
        size: bytes that it is said to unpack to.

    Raises:
        ValueError: why it cannot be used.
    """
    if size > LARGEST:
        message = f"it claims to unpack to {size} bytes, more than {LARGEST}"
        raise ValueError(message)
    try:
        unpacked = _unpacked(packed, compression, size)
    except (zstandard.ZstdError, RuntimeError, EOFError, OSError) as error:
        message = f"{compression} cannot unpack it ({error})"
        raise ValueError(message) from error
    if len(unpacked) != size:
        message = f"it unpacks to {len(unpacked)} bytes where {size} are stated"
        raise ValueError(message)
    return unpacked


def _unpacked(packed: memoryview, compression: str, size: int) -> bytes | memoryview:
    if compression in ("", "none"):
        return packed
    if compression == "zstd":
        # A frame states its size; the library would allocate whatever it states.
        if zstandard.frame_content_size(bytes(packed[:18])) not in (-1, size):
            message = "its zstd frame and its header state different sizes"
            raise ValueError(message)
        return zstandard.ZstdDecompressor().decompress(packed, max_output_size=size)
    if compression == "lz4":
        return lz4.frame.LZ4FrameDecompressor().decompress(packed, max_length=size + 1)
    if compression == "bz2":
        return bz2.BZ2Decompressor().decompress(packed, max_length=size + 1)
    message = f"compression {compression!r} is not one of zstd, lz4, bz2 and none"
    raise ValueError(message)


def unpack_front(packed: memoryview, compression: str, size: int) -> bytes:
    """Return as much of a piece that was cut as unpacks; nothing where none does."""
    if size > LARGEST:
        return b""
    try:
        if compression == "zstd":
            return _zstd_front(packed, size)
        if compression == "lz4":
            return lz4.frame.LZ4FrameDecompressor().decompress(packed, max_length=size)
        if compression == "bz2":
            return bz2.BZ2Decompressor().decompress(packed, max_length=size)
    except (zstandard.ZstdError, RuntimeError, EOFError, OSError):
        return b""
    return bytes(packed) if compression in ("", "none") else b""


def _zstd_front(packed: memoryview, size: int) -> bytes:
    pieces, unpacker = bytearray(), zstandard.ZstdDecompressor().decompressobj()
    for at in range(0, len(packed), 1 << 16):
        pieces += unpacker.decompress(packed[at : at + (1 << 16)])
        if len(pieces) > size:
            return b""
    return bytes(pieces)

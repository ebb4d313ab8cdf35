"""Unpacks compressed pieces of logs, to at most their stated size, so that a small file cannot fill the memory."""

import bz2

import lz4.frame
import zstandard

LARGEST = 1 << 30  #: bytes; a piece with a larger stated size is not unpacked
ZSTD_HEADER = 18  #: bytes at most


def unpack(packed: memoryview, compression: str, size: int) -> bytes | memoryview:
    """Return the content of a packed piece.

    Args:
        packed: the piece.
        compression: ``zstd``, ``lz4``, ``bz2``, ``none`` or an empty text.
        size: its stated size (bytes) when unpacked.

    Raises:
        ValueError: the piece cannot be used; the message states why.
    """
    if size > LARGEST:
        raise ValueError(f"its stated size of {size} bytes is above the limit of {LARGEST}")
    try:
        unpacked = _unpacked(packed, compression, size)
    except (zstandard.ZstdError, RuntimeError, EOFError, OSError) as error:
        raise ValueError(f"{compression} cannot unpack it ({error})") from error
    if len(unpacked) != size:
        raise ValueError(f"it unpacks to {len(unpacked)} bytes, but {size} are stated")
    return unpacked


def _unpacked(packed: memoryview, compression: str, size: int) -> bytes | memoryview:
    if compression in ("", "none"):
        return packed
    if compression == "zstd":
        # The library would allocate the size that the frame states, even if it is very large.
        if zstandard.frame_content_size(bytes(packed[:ZSTD_HEADER])) not in (-1, size):
            raise ValueError("its zstd frame and its header state different sizes")
        return zstandard.ZstdDecompressor().decompress(packed, max_output_size=size)
    if compression == "lz4":
        return lz4.frame.LZ4FrameDecompressor().decompress(packed, max_length=size + 1)
    if compression == "bz2":
        return bz2.BZ2Decompressor().decompress(packed, max_length=size + 1)
    raise ValueError(f"its compression {compression!r} is not supported; zstd, lz4, bz2 and none are")


def unpack_front(packed: memoryview, compression: str, size: int) -> bytes:
    """Return the part of a cut piece that can be unpacked; it may be empty."""
    if size > LARGEST:
        return b""
    try:
        return (
            _zstd_front(packed, size) if compression == "zstd" else bytes(_unpacked(packed, compression, size))[:size]
        )
    except (zstandard.ZstdError, RuntimeError, EOFError, OSError, ValueError):
        return b""


def _zstd_front(packed: memoryview, size: int) -> bytes:
    pieces, unpacker = bytearray(), zstandard.ZstdDecompressor().decompressobj()
    for at in range(0, len(packed), 1 << 16):
        pieces += unpacker.decompress(packed[at : at + (1 << 16)])
        if len(pieces) > size:
            return b""
    return bytes(pieces)

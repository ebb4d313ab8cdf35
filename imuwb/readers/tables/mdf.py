"""Measurement files of the automotive industry (MDF 3 and 4, .mdf, .mf4), read by asammdf, which is an extra (LGPL)."""

from collections.abc import Iterator
from pathlib import Path

from imuwb.readers.batch import Batch, Remark
from imuwb.readers.read_options import ReadOptions

format = "mdf"  # noqa: A001 - the contract's name
uses = ("time_source", "columns", "units", "frame", "epoch")
MAGICS = b"MDF     ", b"UnFinMF "


def probe(head: bytes) -> bool:
    """Return whether the file begins with MDF's name."""
    return head.startswith(MAGICS)


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the streams of its channels.

    Raises:
        UnreadableLogError: asammdf is not installed, or the file is damaged, or no channel is of a gyro, an accelerometer, or positions.
        UsageError: the units of the channels are unknown.
    """
    from imuwb.readers.tables.mdf_channels import channels  # noqa: PLC0415 - a probe needs no asammdf
    from imuwb.readers.tables.named_arrays import streamed  # noqa: PLC0415

    tree, remarks = channels(path)
    yield from remarks
    yield from streamed(path, options, tree)

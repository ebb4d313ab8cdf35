"""MATLAB's files of version 5 to 7, and of version 7.3: structures of NaveGo, matrices of PSINS, and arrays with names."""

from collections.abc import Iterator
from pathlib import Path

from imuwb.readers.batch import Batch, Remark
from imuwb.readers.read_options import ReadOptions

format = "matlab"  # noqa: A001 - the contract's name
uses = ("time_source", "columns", "units", "frame", "epoch")
MAGICS = b"MATLAB 5.0 MAT-file", b"MATLAB 7.3 MAT-file"


def probe(head: bytes) -> bool:
    """Return whether the file begins with MATLAB's text."""
    return head.startswith(MAGICS)


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the streams of its variables; the file is read whole.

    Raises:
        UnreadableLogError: the file is damaged, or has no arrays of a gyro, an accelerometer, or positions.
        UsageError: the columns, units or rate of the arrays are unknown.
    """
    from imuwb.readers.tables.matlab_variables import variables  # noqa: PLC0415 - a probe needs no scipy and no h5py
    from imuwb.readers.tables.named_arrays import streamed  # noqa: PLC0415

    tree, remarks = variables(path)
    yield from remarks
    yield from streamed(path, options, tree)

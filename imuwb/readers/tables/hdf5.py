"""HDF5 files that MATLAB did not write: arrays with names, units in their names or attributes."""

from collections.abc import Iterator
from pathlib import Path

from imuwb.errors import UnreadableLogError
from imuwb.readers.batch import Batch, Remark, unused
from imuwb.readers.read_options import ReadOptions

format = "hdf5"  # noqa: A001 - the contract's name
uses = ("time_source", "columns", "units", "frame", "epoch")
MAGIC = b"\x89HDF\r\n\x1a\n"


def probe(head: bytes) -> bool:
    """Return whether the file begins with HDF5's magic."""
    return head.startswith(MAGIC)


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the streams of its arrays; the file is read whole.

    Raises:
        UnreadableLogError: the file is damaged, or has no arrays of a gyro, an accelerometer, or positions.
        UsageError: the columns, units or rate of the arrays are unknown.
    """
    from imuwb.readers.tables.hdf5_apart import check_apart  # noqa: PLC0415 - as below
    from imuwb.readers.tables.hdf5_arrays import tree_of  # noqa: PLC0415 - a probe needs no h5py
    from imuwb.readers.tables.matlab_variables import FAULTS  # noqa: PLC0415
    from imuwb.readers.tables.named_arrays import streamed  # noqa: PLC0415
    from imuwb.readers.tables.packed import refuse_packed  # noqa: PLC0415

    refuse_packed(path)
    objects: list[str] = []
    check_apart(path)
    try:
        tree = tree_of(path, objects)
    except FAULTS as error:
        told = (str(error).splitlines() or [type(error).__name__])[0][:120]
        raise UnreadableLogError(
            f"{path}: the HDF5 file cannot be read ({told}); it is cut or damaged: copy it again"
        ) from error
    if objects:
        yield unused(objects, "no arrays of numbers")
    yield from streamed(path, options, tree)

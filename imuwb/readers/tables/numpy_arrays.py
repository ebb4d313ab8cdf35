"""NumPy's arrays: ``.npy``, archives of several (``.npz``), and comma2k19's folders of arrays; no pickle is ever opened."""

from collections.abc import Iterator
from pathlib import Path

from imuwb.readers.batch import Batch, Remark
from imuwb.readers.read_options import ReadOptions

format = "numpy"  # noqa: A001 - the contract's name
uses = ("time_source", "columns", "units", "frame", "epoch")
MAGIC = b"\x93NUMPY"
ZIP, NAME = b"PK\x03\x04", 30  #: magic of an archive, and offset of its first name
SENSORS = Path("IMU")  #: folder of comma2k19's sensors


def probe(head: bytes) -> bool:
    """Return whether the file is an array, or an archive whose first file is one."""
    name = head[NAME : NAME + int.from_bytes(head[26:28], "little")]
    return head.startswith(MAGIC) or (head.startswith(ZIP) and name.endswith(b".npy"))


def probe_folder(folder: Path) -> bool:
    """Return whether a folder has sensors as comma2k19 stores them: folders with the arrays ``t`` and ``value``."""
    from imuwb.readers.tables.comma2k19 import sensors_of  # noqa: PLC0415 - files need no folders

    return bool(sensors_of(folder))


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Return the streams of the arrays.

    Raises:
        UnreadableLogError: the file is damaged, or has no arrays of a gyro, an accelerometer, or positions.
        UsageError: the columns, units or rate of the arrays are unknown.
    """
    from imuwb.readers.tables import comma2k19  # noqa: PLC0415 - a probe needs no arrays
    from imuwb.readers.tables.named_arrays import streamed  # noqa: PLC0415
    from imuwb.readers.tables.numpy_files import arrays  # noqa: PLC0415

    if path.is_dir():
        return comma2k19.streamed(path)
    if comma2k19.is_sensor(path.parent) and path.name in comma2k19.FILES:
        return comma2k19.streamed(path.parent)
    return streamed(path, options, arrays(path))

"""Tables in a packed file are refused with what to do."""

import gzip

import pytest

from imuwb.errors import UnreadableLogError
from imuwb.readers import read

HEADS = {
    "parquet": b"PAR1", "feather": b"ARROW1\0\0", "hdf5": b"\x89HDF\r\n\x1a\n", "matlab": b"MATLAB 5.0 MAT-file", "numpy": b"\x93NUMPY\x01\x00",
    "mdf": b"MDF     4.10    ",
}  # fmt: skip


@pytest.mark.parametrize("name", HEADS)
def test_a_packed_table_is_refused(tmp_path, name):
    if name == "mdf":
        pytest.importorskip("asammdf", reason="the extra imuwb[mdf] is not installed")
    path = tmp_path / "log.gz"
    path.write_bytes(gzip.compress(HEADS[name] + bytes(500)))
    with pytest.raises(UnreadableLogError, match="unpack it first"):
        read(path)

"""Tests of the reader."""

from pathlib import Path

import numpy as np
from imuwb.readers import Batch, ReadOptions, Remark
from imuwb.testing import check

import plugin_name

ROWS = 200


def write(path: Path) -> Path:
    """Write a log whose rows are all different."""
    rows = np.zeros(ROWS, plugin_name.ROW)
    rows["time"] = np.arange(ROWS) * 10_000_000
    rows["rate"] = np.arange(3 * ROWS).reshape(-1, 3) / 1e4
    rows["force"] = (0.0, 0.0, -9.8) + np.arange(3 * ROWS).reshape(-1, 3) / 1e5
    path.write_bytes(plugin_name.FIRST + rows.tobytes())
    return path


def test_it_keeps_the_contract(tmp_path: Path) -> None:
    """All rules of ``imuwb plugins check`` pass, with a log of the format."""
    check(plugin_name, "plugin_name", logs=[write(tmp_path / "log.bin")]).require()


def test_all_rows_are_read(tmp_path: Path) -> None:
    """Times and values are those of the file."""
    (batch,) = plugin_name.stream(write(tmp_path / "log.bin"), ReadOptions())
    assert isinstance(batch, Batch)
    assert batch.time.tolist() == [10_000_000 * i for i in range(ROWS)]
    np.testing.assert_allclose(batch.columns["angular_rate"][7], np.array([21, 22, 23]) / 1e4, rtol=1e-6)


def test_a_cut_row_is_counted(tmp_path: Path) -> None:
    """A file that ends within a row is read as far as it is whole."""
    path = write(tmp_path / "log.bin")
    path.write_bytes(path.read_bytes()[:-5])
    batch, remark = plugin_name.stream(path, ReadOptions())
    assert isinstance(batch, Batch)
    assert isinstance(remark, Remark)
    assert (batch.time.size, remark.count) == (ROWS - 1, 1)

"""Writes the bytes of a receiver's log and reads them."""

import pytest

from imuwb.readers import ReadOptions, read


@pytest.fixture
def log_of(tmp_path):
    def log(*parts, **options):
        path = tmp_path / "log.bin"
        path.write_bytes(b"".join(parts))
        return read(path, ReadOptions(**options))

    return log

"""Functions that write logs of flight controllers and read them."""

import pytest

from imuwb.readers import ReadOptions, read
from tests.readers.flight import dataflash_writer as log
from tests.readers.flight import ulog_writer as px4


@pytest.fixture(scope="module")
def dataflash_of(fresh):
    """Return a function that reads a log of some rows, or of bytes."""

    def read_back(rows):
        path = fresh("log.bin")
        path.write_bytes(rows if isinstance(rows, bytes) else log.binary(rows))
        return read(path)

    return read_back


@pytest.fixture(scope="module")
def tlog_of(fresh):
    """Return a function that writes records and reads them."""

    def log(*records, **options):
        path = fresh("log.tlog")
        path.write_bytes(b"".join(records))
        return read(path, ReadOptions(**options))

    return log


@pytest.fixture(scope="module")
def ulog_of(fresh):
    """Return a function that reads a log of these messages."""

    def read_back(*messages, whole=None):
        path = fresh("log.ulg")
        path.write_bytes(whole or px4.HEADER + px4.flags() + b"".join(messages))
        return read(path)

    return read_back

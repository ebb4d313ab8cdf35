"""Tables from the bytes of a Parquet file."""

from collections.abc import Sequence

import pyarrow as pa
import pyarrow.parquet as pq


def table_in(content: bytes, columns: Sequence[str] | None = None) -> pa.Table:
    """Return the table of a file, or some of its columns.

    ``pyarrow.parquet.read_table`` reads a file as a dataset, which imports pandas and takes twice the time for a small file.

    Raises:
        ValueError: the file is no whole Parquet file.
    """
    try:
        return pq.ParquetFile(pa.BufferReader(content)).read(columns=columns, use_threads=False)
    except (pa.ArrowException, OSError) as error:
        raise ValueError(str(error)) from error

"""What a log states of itself beside its samples, such as the serial number of its recorder, without its samples being read."""

from imuwb.errors import UnreadableLogError
from imuwb.readers.bytes import source
from imuwb.readers.reading import reader_of


def stated(place: str) -> dict[str, str]:
    """Return the metadata of a log, {key: text}; empty for a format without metadata, and for a log that cannot be read.

    The keys of MCAP are ``NAME.KEY`` of its metadata records, those of ULog the names of its information messages.
    """
    with source.accessed(place) as path:
        try:
            known = getattr(reader_of(path), "stated", None)
            return {} if known is None else known(path)
        except UnreadableLogError:
            return {}

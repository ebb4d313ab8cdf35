"""MCAP logs: IMU, GNSS, temperature and speed messages of any topic, recognised by the names of their fields."""

from collections.abc import Iterator
from pathlib import Path

from imuwb.readers.batch import Batch, CannotSeekError, Limits, Remark
from imuwb.readers.bytes.source import Source
from imuwb.readers.containers.recording_folder import Form, has_recording, has_several, parts_of
from imuwb.readers.read_options import ReadOptions
from imuwb.ros import MCAP_MAGIC
from imuwb.summary import LogSummary

format = "mcap"  # noqa: A001 - the contract's name
uses = ("time_source", "frame", "messages")
ranged = True


def probe(head: bytes) -> bool:
    """Return whether the file begins with MCAP's magic."""
    return head.startswith(MCAP_MAGIC)


FORM = Form(".mcap", probe)


def probe_folder(folder: Path) -> bool:
    """Return whether a folder has MCAP files, such as that of a rosbag2 recording."""
    return has_recording(folder, FORM)


def has_several_logs(folder: Path) -> bool:
    """Return whether a folder has several recordings."""
    return has_several(folder, FORM)


def describe(path: Source, options: ReadOptions) -> LogSummary | None:
    """Return a summary from the file's index, without reading its messages; None without an index.

    The summary of a folder is that of all its files.
    """
    from imuwb.readers.containers import mcap_index  # noqa: PLC0415 - only large files are summarised this way

    if isinstance(path, Path) and path.is_dir():
        return mcap_index.describe_parts(path, parts_of(path, FORM), options)
    return mcap_index.describe(path, options)


def stated(path: Source) -> dict[str, str]:
    """Return the metadata records of a file with an index, {"NAME.KEY": text}."""
    from imuwb.readers.containers import mcap_index  # noqa: PLC0415 - as above

    return {} if isinstance(path, Path) and path.is_dir() else mcap_index.stated(path)


def stream(path: Source, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Return the messages chunk by chunk.

    Raises:
        UnreadableLogError: the file has no whole message.
    """
    from imuwb.readers.containers.mcap_records import Recording  # noqa: PLC0415 - a probe and an index need no compiled code
    from imuwb.readers.containers.split import container_of  # noqa: PLC0415
    from imuwb.readers.containers.topics import streamed  # noqa: PLC0415

    return streamed(path, container_of(path, FORM, Recording), options)


def part(path: Source, options: ReadOptions, limits: Limits) -> Iterator[Batch | Remark]:
    """Return the messages of the chunks that have rows of a part, by the file's index.

    Raises:
        CannotSeekError: the file has no index, or its chunks are in no order of time.
    """
    if isinstance(path, Path) and path.is_dir():
        raise CannotSeekError
    from imuwb.readers.containers import mcap_part  # noqa: PLC0415 - a probe needs neither the library nor compiled code

    return mcap_part.part(path, options, limits)

"""ROS 1 bags: IMU, GNSS, temperature and speed messages of any topic, recognised by the names of their fields."""

from collections.abc import Iterator
from pathlib import Path

from imuwb.readers.batch import Batch, CannotSeekError, Limits, Remark
from imuwb.readers.bytes.source import Source
from imuwb.readers.containers.messages import BAG_MAGIC
from imuwb.readers.containers.recording_folder import Form, has_recording, has_several
from imuwb.readers.read_options import ReadOptions

format = "bag"  # noqa: A001 - the contract's name
uses = ("time_source", "frame", "messages")
ranged = True


def probe(head: bytes) -> bool:
    """Return whether the file begins as a bag of version 2.0."""
    return head.startswith(BAG_MAGIC)


FORM = Form(".bag", probe)


def probe_folder(folder: Path) -> bool:
    """Return whether a folder has bags, such as the parts of a split one."""
    return has_recording(folder, FORM)


def has_several_logs(folder: Path) -> bool:
    """Return whether a folder has several recordings."""
    return has_several(folder, FORM)


def stream(path: Source, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Return the messages chunk by chunk.

    Raises:
        UnreadableLogError: the file has no whole message.
    """
    from imuwb.readers.containers.bag_records import Bag  # noqa: PLC0415 - a probe needs no compiled code
    from imuwb.readers.containers.split import container_of  # noqa: PLC0415
    from imuwb.readers.containers.topics import streamed  # noqa: PLC0415

    return streamed(path, container_of(path, FORM, Bag), options)


def part(path: Source, options: ReadOptions, limits: Limits) -> Iterator[Batch | Remark]:
    """Return the messages of the chunks that have rows of a part, by the bag's index.

    Raises:
        CannotSeekError: the bag has no index, or its chunks are in no order of time.
    """
    if isinstance(path, Path) and path.is_dir():
        raise CannotSeekError
    from imuwb.readers.containers import bag_part  # noqa: PLC0415 - a probe needs no compiled code

    return bag_part.part(path, options, limits)

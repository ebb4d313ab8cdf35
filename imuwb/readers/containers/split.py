"""A recording that consists of several files, or of a packed file, as one container."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import cast

from imuwb.notes import Note
from imuwb.readers.bytes import source
from imuwb.readers.bytes.source import Source
from imuwb.readers.bytes.whole_file import unpacked
from imuwb.readers.containers.messages import Container, Messages
from imuwb.readers.containers.recording_folder import Form, Parts, other_parts, parts_of

Make = Callable[[Path], Container]


def container_of(path: Source, form: Form, make: Make) -> Container:
    """Return the container of a log, or of the recording in a folder.

    Args:
        path: a file, a folder, or a remote log.
        form: the format of the files.
        make: returns the container of one file that is not packed.

    Raises:
        UnreadableLogError: the folder has several recordings, or none.
    """
    if isinstance(path, Path) and path.is_dir():
        return Split(parts_of(path, form), make)
    with source.open_unpacked(path) as file:
        packed = source.is_packed(file)
    whole = Split(Parts((cast("Path", path),)), make) if packed else make(cast("Path", path))
    whole.notes.extend(other_parts(path) if isinstance(path, Path) else ())
    return whole


class Split(Container):
    """The files of a recording, read one after another."""

    def __init__(self, parts: Parts, make: Make) -> None:
        """Set the parts; nothing is read yet."""
        super().__init__()
        self._parts, self._make = parts, make
        self.notes.extend(parts.notes)

    def messages(self) -> Iterator[Messages]:
        """Yield the messages of all parts."""
        before = count = 0
        for file in self._parts.files:
            faults: list[str] = []
            size = source.size(file)
            with unpacked(file, faults) as whole:
                part = self._make(whole)
                # The numbers of channels are those of the part that is read.
                self.schemas, self.channels, self.above_sea = part.schemas, part.channels, part.above_sea
                share, of_part = size / max(source.size(whole), 1), 0
                for messages in part.messages():
                    of_part += messages.start.size
                    yield replace(messages, bytes_read=before + int(messages.bytes_read * share))
            self._note(file, [*faults, *part.notes], of_part)
            self.truth |= part.truth
            before, count = before + size, count + of_part
        stated = self._parts.messages
        if stated is not None and count < stated:
            text = f"{stated - count} of the {stated} messages that the recording states are not in its files"
            self.notes.append(Note("messages_missing", text))

    def _note(self, file: Path, faults: list[str], count: int) -> None:
        """Add the notes of a part, with its name if there are several parts."""
        if not count:
            faults = faults or [Note("empty_part", "no message can be read")]
        several = len(self._parts.files) > 1
        self.notes += [
            Note(getattr(fault, "id", "part"), f"{file.name}: {fault}" if several else fault) for fault in faults
        ]

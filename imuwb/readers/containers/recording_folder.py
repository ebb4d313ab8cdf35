"""Which files of a folder are the parts of one recording, and in which order.

rosbag2 writes a folder with ``metadata.yaml`` and numbered files; rosbag of ROS 1 writes numbered files, perhaps with the date
at which each begins. Sources: ros2/rosbag2, rosbag2_storage (metadata_io), rosbag2_cpp (compression of files);
ros/ros_comm, rosbag recorder (--split).
"""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from imuwb.errors import UnreadableLogError
from imuwb.notes import Note
from imuwb.readers.bytes import source
from imuwb.texts import names_text

METADATA = "metadata.yaml"
SUFFIXES = (".bag", ".db3", ".mcap")  #: of all formats of recordings
PACKED = (".zstd", ".zst", ".gz")  #: suffixes of packed files
_NUMBERED = re.compile(r"^(.*?)(?:[_-]?\d{4}(?:[_-]\d{2}){2,6})?_(\d+)$")
_LIST = re.compile(r"^\s*relative_file_paths:[ \t]*(\[[^\]]*\]|(?:\n[ \t]*- [^\n]*)*)", re.MULTILINE)
_ITEM = re.compile(r"""[\[\s,-]+["']?([^"'\[\],\n]+?)["']?\s*(?=[,\]\n]|$)""")
_COUNT = re.compile(r"^  message_count:\s*(\d+)\s*$", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Form:
    """A format of recordings as files."""

    suffix: str  #: of its files, before that of a packed one
    probe: Callable[[bytes], bool]


@dataclass(frozen=True, slots=True)
class Parts:
    """The files of a recording."""

    files: tuple[Path, ...]
    notes: tuple[Note, ...] = ()
    messages: int | None = None  #: number of messages, if the recording states it


@dataclass(frozen=True, slots=True)
class _Metadata:
    files: tuple[str, ...]
    messages: int | None


def has_recording(folder: Path, form: Form) -> bool:
    """Return whether a folder has files of a format, or metadata that list some."""
    metadata = _metadata(folder)
    if metadata is not None and metadata.files:
        return any(_without_packing(name).endswith(form.suffix) for name in metadata.files)
    return any(_is(file, form) for file in _named(folder, form))


def has_several(folder: Path, form: Form) -> bool:
    """Return whether a folder has several recordings of a format, of which none is stated to be the folder's."""
    metadata = _metadata(folder)
    return (metadata is None or not metadata.files) and _are_apart(_files(folder, form))


def _files(folder: Path, form: Form) -> list[Path]:
    """Return the files of a format; of a file and its packed form, the file."""
    known = [file for file in _named(folder, form) if _is(file, form)]
    files = list({_stem(file): file for file in sorted(known, key=_is_packed, reverse=True)}.values())
    return sorted(files, key=known.index)


def _are_apart(files: Sequence[Path]) -> bool:
    """Return whether several files are recordings of their own, not the numbered parts of one."""
    numbered = [_NUMBERED.match(_stem(file)) for file in files]
    return len(files) > 1 and (None in numbered or len({match[1] for match in numbered if match is not None}) > 1)


def parts_of(folder: Path, form: Form) -> Parts:
    """Return the parts of the recording in a folder: those of its metadata in their order, or else its numbered files.

    Raises:
        UnreadableLogError: the folder has several recordings, or none.
    """
    metadata = _metadata(folder)
    if metadata is not None and metadata.files:
        return replace(_stated(folder, form, metadata), messages=metadata.messages)
    files = _files(folder, form)
    notes = _not_used(folder, files)
    if not files:
        raise UnreadableLogError(f"{folder}: no {form.suffix} file in this folder can be read; copy it again")
    if len(files) == 1:
        return Parts(tuple(files), tuple(notes))
    numbered = {file: _NUMBERED.match(_stem(file)) for file in files}
    if _are_apart(files):
        names = names_text([file.name for file in files])
        raise UnreadableLogError(f"{folder}: this folder has several recordings ({names}); name one of them")
    places = {int(match[2]): file for file, match in numbered.items() if match is not None}
    missing = [str(number) for number in range(max(places)) if number not in places]
    notes.insert(0, _joined(files))
    if missing:
        text = f"parts {names_text(missing)} of {max(places) + 1} (numbered from 0) are not in the folder"
        notes.append(Note("part_missing", text))
    return Parts(tuple(places[number] for number in sorted(places)), tuple(notes))


def other_parts(file: Path) -> tuple[Note, ...]:
    """Return a note if a file is one of several parts of the recording in its folder."""
    metadata = _metadata(file.parent)
    names = [] if metadata is None else [Path(name).name for name in metadata.files]
    if len(names) < 2 or file.name not in names:  # noqa: PLR2004 - parts
        return ()
    text = f"{file.name} is one of {len(names)} parts of a recording; give the folder {file.parent} to read them as one log"
    return (Note("one_part", text),)


def _stated(folder: Path, form: Form, metadata: _Metadata) -> Parts:
    found: list[Path] = []
    notes: list[Note] = []
    for name in metadata.files:
        file = _present(folder, Path(name).name)
        if file is None:
            notes.append(Note("part_missing", f"{name} is listed in {METADATA}, but it is not in the folder"))
        else:
            found.append(file)
    notes += _not_used(folder, found)
    if not found:
        raise UnreadableLogError(
            f"{folder}: none of the files that {METADATA} lists is in the folder: {names_text(list(metadata.files))}"
        )
    if len(found) > 1:
        notes.insert(0, _joined(found))
    return Parts(tuple(found), tuple(notes))


def _joined(files: list[Path]) -> Note:
    return Note("parts", f"{len(files)} files are read as one log: {names_text([file.name for file in files])}")


def _not_used(folder: Path, files: list[Path]) -> list[Note]:
    """Return the note on the other recordings in a folder, of any format; no note without any."""
    others = [file.name for suffix in SUFFIXES for file in _of_suffix(folder, suffix) if file not in files]
    text = f"not used: {names_text(others)} (beside the files that are read; name a file to read it)"
    return [Note("unused", text)] if others else []


def _present(folder: Path, name: str) -> Path | None:
    """Return a file of a name, packed or not, whatever its metadata says; None if there is none."""
    bare = _without_packing(name)
    names = (name, bare, *(bare + suffix for suffix in PACKED))
    return next((folder / other for other in names if (folder / other).is_file()), None)


def _metadata(folder: Path) -> _Metadata | None:
    try:
        text = (folder / METADATA).read_text("utf-8", "replace")
    except OSError:
        return None
    block, count = _LIST.search(text), _COUNT.search(text)
    files = tuple(_ITEM.findall(block[1])) if block else ()
    return _Metadata(files, int(count[1]) if count else None)


def _named(folder: Path, form: Form) -> list[Path]:
    """Return the files whose names end as those of a format, the tenth after the ninth."""
    return _of_suffix(folder, form.suffix)


def _of_suffix(folder: Path, suffix: str) -> list[Path]:
    ends = suffix, f"{suffix}.active"
    files = [file for file in folder.iterdir() if _without_packing(file.name).endswith(ends) and file.is_file()]
    return sorted(files, key=lambda file: [int(x) if x.isdigit() else x for x in re.split(r"(\d+)", file.name)])


def _is(file: Path, form: Form) -> bool:
    return file.is_file() and form.probe(source.head(file))


def _without_packing(name: str) -> str:
    return next((name.removesuffix(suffix) for suffix in PACKED if name.endswith(suffix)), name)


def _is_packed(file: Path) -> bool:
    return _without_packing(file.name) != file.name


def _stem(file: Path) -> str:
    return _without_packing(file.name).removesuffix(".active").rpartition(".")[0]

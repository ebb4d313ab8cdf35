"""The renames of one run, in a journal: if the run is killed between two of them, the next process of imuwb does the rest.

No file system renames several files at once. So a run first has all its drafts on the disk; then it writes a journal of what gets which
name, and from then on it counts as done. The next process that reads or writes a file in one of the folders does what is left to do. The
journal is beside the first file; in each other folder there is one that leads to it. A draft is renamed only if it has the mark that the
journal states and no process writes it, so a journal that is old, cut or foreign renames nothing.
"""

import errno
import json
import os
import stat
import sys
import time
import warnings
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO, cast

from imuwb.sidecars import mark_of

FAR = 1 << 40  #: place of the byte that is locked on Windows, where a lock keeps others from the bytes
BUSY = (errno.EACCES, errno.EAGAIN, errno.EDEADLK)
LARGEST = 1 << 20  #: bytes of a journal
RECENT = 2 * 10**9  #: ns; a folder that was changed so lately may change again at the same time stamp
SUFFIX = ".renames"
_seen: dict[Path, int] = {}  #: when the folders without journals were changed, ns


def draft_of(place: Path) -> Path:
    """Return the name that a file has until it is finished."""
    return place.with_name(f".{place.name}.partial")


def journal_of(place: Path) -> Path:
    """Return the name of the journal of a run whose first file in this folder is at ``place``."""
    return place.with_name(f".{place.name}{SUFFIX}")


def begin(places: Sequence[Path]) -> list[Path]:
    """Write the journal of a run whose drafts are on the disk; return the files to remove when all drafts have their names.

    Raises:
        OSError: a journal cannot be written.
    """
    first = journal_of(places[0])
    heads = {place.parent: place for place in reversed(places)}  # the first of each folder
    leading = [journal_of(place) for folder, place in heads.items() if folder != first.parent]
    listed = {place.name if place.parent == first.parent else str(place): mark_of(draft_of(place)) for place in places}
    journals = [*leading, first]
    try:
        for journal in journals:
            content = {"schema": 1, "files": listed} if journal is first else {"schema": 1, "journal": str(first)}
            with journal.open("w", encoding="ascii") as file:
                json.dump(content, file)
                file.flush()
                os.fsync(file.fileno())
            folder_to_disk(journal.parent)
    except OSError:
        end(journals)
        raise
    return journals


def end(journals: Sequence[Path]) -> None:
    """Remove the journals of a run whose files have their names, or will not get them."""
    for journal in reversed(journals):  # the one that lists the files first: the others mean nothing without it
        with suppress(OSError):
            journal.unlink(missing_ok=True)


def settle(path: Path) -> None:
    """Do the renames that a killed run has left in the folder of a file, or in the folder itself; warn if that cannot be done."""
    with suppress(OSError, ValueError):  # no such folder: others say so
        path = path.resolve()
        folder = path if path.is_dir() else path.parent
        changed = folder.stat().st_mtime_ns
        if _seen.get(folder) == changed:
            return
        with os.scandir(folder) as entries:
            journals = [Path(e) for e in entries if e.name.endswith(SUFFIX) and e.name.startswith(".") and _plain(e)]
        for journal in sorted(journals):
            _finish(journal)
        if time.time_ns() - changed > RECENT:
            _seen[folder] = changed


def _plain(entry: os.DirEntry[str]) -> bool:
    return entry.is_file(follow_symlinks=False)


def _finish(journal: Path) -> None:
    """Do what a journal says, as far as it is to be done."""
    content = _content(journal)
    if isinstance(first := content.get("journal"), str):
        journal, leading = Path(first), [journal]
        content = _content(journal)
    else:
        leading = []
    files = content.get("files")
    if not isinstance(files, dict):
        return  # cut, foreign, or of a run whose files are not all on the disk
    left, folders = list[str](), {journal.parent}
    for name, mark in cast("dict[str, object]", files).items():
        place = journal.parent / name
        folders.add(place.parent)
        try:
            done = _renamed(place, mark)
        except OSError as error:
            warnings.warn(
                f"{place}: the run that wrote this file was ended before the file got its name, and it cannot get it now ({error.strerror or error}); "
                f"its content is in {draft_of(place)}", stacklevel=2,
            )  # fmt: skip
            done = False
        left += [] if done else [name]
    if not left:
        for folder in folders:
            folder_to_disk(folder)
        others = [other for folder in folders - {journal.parent} for other in _leading(folder, journal)]
        end([*leading, *others, journal])


def _leading(folder: Path, journal: Path) -> list[Path]:
    """Return the journals in a folder that lead to another one."""
    return [path for path in folder.glob(f".*{SUFFIX}") if _content(path).get("journal") == str(journal)]


def _content(journal: Path) -> dict[str, object]:
    """Return what a journal says; nothing if it is cut or foreign."""
    with suppress(OSError, ValueError, RecursionError):
        if stat.S_ISREG(journal.stat().st_mode):
            with journal.open("rb") as file:
                content: object = json.loads(file.read(LARGEST))
            if isinstance(content, dict):
                return cast("dict[str, object]", content)
    return {}


def _renamed(place: Path, mark: object) -> bool:
    """Give a draft its name, if it is the one with this mark; return whether nothing is left to do.

    Raises:
        OSError: it cannot get its name.
    """
    try:
        draft = draft_of(place)
        if not stat.S_ISREG(draft.lstat().st_mode):
            return True
        lock = locked(draft, keep=True)
    except (FileNotFoundError, ValueError):
        return True  # it has its name; or this is no name of a file
    if lock is None:
        return False  # its process is about to do the same
    with lock:
        if mark_of(draft) == mark:
            if os.name == "nt":  # no open file can be renamed there
                lock.close()
            draft.replace(place)
    return True


def folder_to_disk(folder: Path) -> None:
    """Wait until the names in a folder are on the disk, where the system can do so."""
    with suppress(OSError):
        number = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(number)
        finally:
            os.close(number)


def locked(draft: Path, *, keep: bool = False) -> BinaryIO | None:
    """Return the open and locked file of a draft; None: another process has the lock.

    Args:
        draft: the file.
        keep: whether it must exist, and keeps its content; otherwise it is made, or made empty.

    Raises:
        OSError: it cannot be opened.
    """
    while True:
        file = draft.open("r+b" if keep else "ab")
        if not _lock(file):
            file.close()
            return None
        # Between opening and locking, the other process may have renamed or removed it.
        with suppress(FileNotFoundError):
            if os.path.samestat(os.fstat(file.fileno()), draft.stat()):
                if not keep:
                    file.truncate(0)
                return file
        file.close()


def _lock(file: BinaryIO) -> bool:
    """Lock a file for this process, and return whether no other one has the lock; some file systems have no locks."""
    try:
        if sys.platform == "win32":
            import msvcrt  # noqa: PLC0415 - of that system alone

            file.seek(FAR)
            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
            file.seek(0)
        else:
            import fcntl  # noqa: PLC0415 - of the other systems

            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        return error.errno not in BUSY
    return True

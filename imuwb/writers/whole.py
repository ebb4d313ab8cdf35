"""Writes files whole: each is a draft in the same folder, gets on the disk, and is then renamed.

A process locks each of its drafts. A second process that wants to write the same file gets an error. A process that was killed
leaves a draft without a lock; the next process that writes the file uses the draft's place again. The drafts of one run are
renamed together, after the last one is finished, by a journal (``imuwb/renames.py``).
"""

import os
import signal
import threading
from collections.abc import Generator, Iterable
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

from imuwb.errors import ImuwbError
from imuwb.renames import begin, draft_of, end, folder_to_disk, locked, settle

SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP")  #: wait until all files of a run have their names


@dataclass(slots=True, eq=False)
class Draft:
    """A file that is not finished. It is at ``path``, and will be at ``place``; its process holds a lock."""

    place: Path
    path: Path
    lock: BinaryIO
    together: bool = False  #: whether it is renamed with others
    finished: bool = False

    @staticmethod
    def of(place: str | Path, *, together: bool = False) -> "Draft":
        """Return an empty draft; that of the run, if the file is renamed together with others.

        Raises:
            ImuwbError: it cannot be written, or another process writes it.
        """
        place = Path(place).resolve()  # a link stays a link, and leads to the new file
        if (draft := _together.get(place)) is not None:
            return draft
        path = draft_of(place)
        settle(place)
        try:
            lock = locked(path)
        except OSError as error:
            raise _failure(place, error) from error
        if lock is None:
            raise ImuwbError(
                f"{place}: another process of imuwb writes this file now; wait for its end, or choose another name"
            )
        return Draft(place, path, lock, together)

    def finish(self) -> None:
        """Give the file its name; if it belongs to others, they get their names together.

        Raises:
            ImuwbError: the file cannot be written.
        """
        self.finished = True
        if not self.together:
            _rename([self])

    def discard(self) -> None:
        """Remove the draft, unless it has its name."""
        if self.lock.closed:
            return
        if os.name == "nt":  # no open file can be removed there
            self.lock.close()
        with suppress(OSError):
            self.path.unlink(missing_ok=True)
        self.lock.close()

    def to_disk(self) -> None:
        """Wait until the bytes of the file are on the disk."""
        with self.path.open("r+b") as file:
            os.fsync(file.fileno())

    def rename(self) -> None:
        """Give the file its name."""
        if os.name == "nt":
            self.lock.close()
        self.path.replace(self.place)
        self.lock.close()


class _Blocks(threading.local):
    """The drafts of the blocks of a thread that are not at their end, the outermost block first."""

    def __init__(self) -> None:
        self.drafts: list[list[Draft]] = []


_together: dict[Path, Draft] = {}  #: drafts of this process that are renamed together
_blocks = _Blocks()


@contextmanager
def together(places: Iterable[str | Path]) -> Generator[None]:
    """Rename the files at ``places`` that are written in the block after its end, in the order in which they were begun.

    After an error, none is renamed. A file at another place is renamed when it is finished. The files of a block in another block are
    renamed with those of the outer one.

    Raises:
        ImuwbError: a file cannot be written, or another process writes it.
    """
    own: list[Draft] = []
    outer = _blocks.drafts[-1] if _blocks.drafts else None
    try:
        with _signals_wait():
            _blocks.drafts.append(own)
            for place in dict.fromkeys(Path(p).resolve() for p in places):
                if place not in _together:
                    own.append(Draft.of(place, together=True))
                    _together[place] = own[-1]
        yield
        if outer is None:
            _rename([draft for draft in own if draft.finished])
        else:
            outer += own
            own = []
    finally:
        with _signals_wait():
            _blocks.drafts.pop()
            for draft in own:
                _together.pop(draft.place, None)
                draft.discard()


@contextmanager
def whole_file(path: str | Path) -> Generator[Path]:
    """Yield a path to write to; after the block the file is at ``path``; after an error it is nowhere.

    Raises:
        ImuwbError: the file cannot be written, or another process writes it.
    """
    draft: Draft | None = None
    try:
        with _signals_wait():
            draft = Draft.of(path)
        yield draft.path
        draft.finish()
    except OSError as error:
        raise _failure(Path(path).resolve(), error) from error
    finally:
        if draft is not None and not draft.together:
            draft.discard()


def write_text(path: str | Path, text: str) -> None:
    """Write a text file, whole or not at all; a character that UTF-8 does not have, such as a part of a file's name, is replaced."""
    with whole_file(path) as temporary:
        temporary.write_text(text, "utf-8", "replace")


def _failure(place: Path, error: OSError) -> ImuwbError:
    return ImuwbError(f"{place}: cannot be written: {error.strerror or error}")


def _rename(drafts: list[Draft]) -> None:
    """Give finished files their names."""
    done: list[str] = []
    for draft in drafts:
        try:
            draft.to_disk()
        except OSError as error:
            raise _failure(draft.place, error) from error
    with _signals_wait():
        try:
            journals = begin([draft.place for draft in drafts]) if len(drafts) > 1 else []
        except OSError as error:
            raise _failure(drafts[0].place, error) from error
        for draft in drafts:
            try:
                draft.rename()
            except OSError as error:
                end(journals)
                others = (
                    f"; of the same run, {', '.join(done)} {'is' if len(done) == 1 else 'are'} written" if done else ""
                )
                raise ImuwbError(f"{_failure(draft.place, error)}{others}") from error
            done.append(draft.place.name)
        for folder in {draft.place.parent for draft in drafts}:
            folder_to_disk(folder)
        end(journals)


@dataclass(slots=True)
class _Waiting:
    """Signals that came while they had to wait."""

    came: list[int] = field(default_factory=list[int])

    def note(self, number: int, frame: object) -> None:
        del frame
        self.came.append(number)


@contextmanager
def _signals_wait() -> Generator[None]:
    """Deliver signals after the block, so that they leave no draft, and no file of a run without the others."""
    if threading.current_thread() is not threading.main_thread():  # only the main thread has handlers, and runs them
        yield
        return
    waiting_signals = _Waiting()
    numbers = [getattr(signal, name) for name in SIGNALS if hasattr(signal, name)]
    kept = [n for n in numbers if signal.getsignal(n) not in (None, signal.SIG_IGN)]
    before = {number: signal.signal(number, waiting_signals.note) for number in kept}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        for number in waiting_signals.came:
            signal.raise_signal(number)

"""Notes: sentences that a reader of a result must know, each with an id for programs and tests."""

from collections.abc import Iterable
from typing import Self


class Note(str):
    """A sentence with an id, such as "moving". The sentence may change; the id stays.

    A note is a str: a terminal, a recording and a document show its sentence.
    """

    __slots__ = ("id",)
    id: str

    def __new__(cls, id: str, text: str) -> Self:  # noqa: A002 - this is an id
        """Return a note."""
        note = super().__new__(cls, text)
        note.id = id
        return note

    def __reduce__(self) -> tuple[type[Self], tuple[str, str]]:
        """Return how copy and pickle make the note again."""
        return type(self), (self.id, str(self))


def ids(notes: Iterable[str]) -> tuple[str, ...]:
    """Return the ids of the notes among some texts; plain texts have no id."""
    return tuple(note.id for note in notes if isinstance(note, Note))

"""What a reader of a result must know, as a sentence that programs and tests know by its id."""

from __future__ import annotations

from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from collections.abc import Iterable


class Note(str):
    """A sentence with an id, such as "moving": the sentence may be re-worded, the id stays.

    It is a text wherever a text is wanted: in a terminal, a recording, a document.
    """

    __slots__ = ("id",)
    id: str

    def __new__(cls, id: str, text: str) -> Self:  # noqa: A002 - it is one
        """Return a note."""
        note = super().__new__(cls, text)
        note.id = id
        return note


def ids(notes: Iterable[str]) -> tuple[str, ...]:
    """Return the ids of those notes among some texts that have one."""
    return tuple(note.id for note in notes if isinstance(note, Note))

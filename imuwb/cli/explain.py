"""imuwb explain: what a term, a verdict or a fault means."""

import textwrap
from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated

import typer

from imuwb.errors import UsageError
from imuwb.explanations import explanation_of, explanations, near
from imuwb.notes import Note, ids

if TYPE_CHECKING:  # help must not wait for numpy
    from imuwb.analysis import Answer

WIDTH = 80  #: columns


def names_in(answer: "Answer", shown: "Iterable[object]") -> tuple[str, ...]:
    """Return the verdicts in an answer's rows, and the ids of notes, that are explained, each once."""
    said = [cell for row in answer.rows for cell in row] + [item.id for item in shown if isinstance(item, Note)]
    return tuple(dict.fromkeys(word for word in said if word in explanations() and len(word) > 1))


def where_explained(answer: "Answer", shown: "Iterable[object]") -> tuple[Note, ...]:
    """Return where the verdicts and notes of a run are explained: by ``imuwb explain``, and at which anchors of the documentation."""
    shown = tuple(shown)
    said: list[Note] = []
    if named := names_in(answer, shown):
        text = f"imuwb explain NAME says what these mean, and so does the glossary of the documentation (#term-NAME): {', '.join(named)}"
        said.append(Note("explained", text))
    if known := tuple(dict.fromkeys(ids(item for item in shown if isinstance(item, str)))):
        text = f"ids of the notes above, each with its place (#note-ID) on the page of notes of the documentation: {', '.join(known)}"
        said.append(Note("ids", text))
    return tuple(said)


def explain(
    term: Annotated[
        list[str] | None,
        typer.Argument(
            help="A term, a verdict or a fault, as imuwb prints it; without one, all are listed.", metavar="TERM"
        ),
    ] = None,
) -> None:
    """Say in a paragraph what a term, a verdict or a fault means.

    Example: imuwb explain bias instability
    """
    if not term:
        for group in dict.fromkeys(one.group for one in explanations().values()):
            names = ", ".join(one.name for one in explanations().values() if one.group == group)
            typer.echo(textwrap.fill(f"{group}: {names}", WIDTH, subsequent_indent="  "))
        return
    word = " ".join(term)
    found = explanation_of(word)
    if found is None:
        offered = near(word)
        like = f"; near it are {', '.join(offered)}" if offered else ""
        raise UsageError(f"{word}: nothing of that name is explained{like}; imuwb explain lists all")
    also = f" ({', '.join(found.also)})" if found.also else ""
    typer.echo(textwrap.fill(f"{found.name}{also}", WIDTH))
    for paragraph in found.text.split("\n\n"):
        typer.echo(textwrap.fill(paragraph, WIDTH))

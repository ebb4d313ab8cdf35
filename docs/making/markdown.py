"""Parts of a page in Markdown."""

from collections.abc import Iterable, Sequence
from pathlib import Path


def table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table."""
    lines = ["| " + " | ".join(map(cell, row)) + " |" for row in (headings, *rows)]
    lines.insert(1, "|" + " --- |" * len(headings))
    return "\n".join(lines)


def cell(text: str) -> str:
    """Return a text that stays in its cell, and is no markup."""
    return " ".join(text.split()).replace("|", "\\|").replace("<", "\\<").replace("*", "\\*")


def console(command: str, output: str) -> str:
    """Return a command with what it printed when the site was built: a block of text, as ``command-output`` makes one."""
    return f"```text\n$ {command}\n{output.rstrip()}\n```"


def index(folder: Path, title: str, text: str, names: Iterable[str]) -> None:
    """Write the first page of a folder, with the contents."""
    contents = "\n".join(names)
    (folder / "index.md").write_text(
        f"# {title}\n\n{text}\n\n```{{toctree}}\n:maxdepth: 1\n\n{contents}\n```\n", "utf-8"
    )

"""The papers: every table and figure with the command that makes it, and ours beside theirs."""

from pathlib import Path

import imuwb
from imuwb_plugins.reproduce import METHODS
from imuwb_plugins.reproduce.comparison import Reproduction, TableComparison
from imuwb_plugins.reproduce.shown import HEADINGS, cells_of
from making.markdown import index, table

SHORT = ("Quinchia and others (2013)", "El-Diasty and others", "Hassaballa and others")


def make(folder: Path) -> None:
    """Write a page for each paper."""
    for name in METHODS:
        result: Reproduction = imuwb.run(f"reproduce {name}").result
        (folder / f"{name}.md").write_text(_page(name, result), "utf-8")
    index(
        folder, "The papers",
        "imuwb implements three papers. Each page has every table of a paper beside ours, and the command for every table, figure and "
        "equation. The numbers are made when these pages are built, with `imuwb reproduce`.",
        [f"{short} <{name}>" for name, short in zip(METHODS, SHORT, strict=True)],
    )  # fmt: skip


def _page(name: str, result: Reproduction) -> str:
    parts = [
        f"(paper-{name})=\n# {result.title}", result.source, f"```console\n$ imuwb reproduce {name}\n```", f"Ours: {result.data}.",
        result.rule, *map(_table, result.tables), "## Figures",
        table(("figure", "what", "made with"), [(f.number, f.title, f.reason or f"`{f.command}`") for f in result.figures]),
        "## Equations", table(("equation", "what", "where"), [(e.number, ". ".join((e.title, *e.readings)), f"`{e.command}`") for e in result.equations]),
    ]  # fmt: skip
    return "\n\n".join(parts) + "\n"


def _table(compared: TableComparison) -> str:
    parts = [f"## {compared.name.capitalize()}: {compared.title}"]
    if compared.reason:
        return "\n\n".join([*parts, compared.reason])
    parts.append(f"Made with `{compared.command}`.")
    parts += [f"- {reading}" for reading in compared.readings]
    return "\n\n".join([*parts, table(HEADINGS, [cells_of(row) for row in compared.rows])])

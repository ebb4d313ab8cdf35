"""The notes that imuwb may print, each with its anchor: their sentences are taken from the code."""

import ast
from collections.abc import Iterator
from importlib.resources import files
from pathlib import Path

from imuwb.explanations import anchor_of, explanation_of
from making.markdown import cell

PACKAGES = ("imuwb", "imuwb_plugins")
CLASS = "Note"
GIVEN = "…"  #: stands for what a run puts into a sentence
ABOUT = """\
A note is a sentence that a reader of a result must know. It has an id, which stays when the sentence changes: a program looks for the id. `--full` prints all
notes, and at the end the ids of those it has printed. In the sentences below, … stands for what a run fills in.
"""


def make(folder: Path) -> None:
    """Write the page of notes."""
    parts = ["(notes)=", "# Notes", ABOUT]
    for name, places in sorted(notes().items()):
        parts += [f"(note-{anchor_of(name)})=", f"## {name}"]
        explained = explanation_of(name)
        if explained is not None:
            parts += [f"[{explained.name}](#term-{explained.anchor}) in the glossary says what it means."]
        parts += ["\n".join(f"- {cell(text)} (`{module}`)" for text, module in places)]
    (folder / "index.md").write_text("\n\n".join(parts) + "\n", "utf-8")


def notes() -> dict[str, list[tuple[str, str]]]:
    """Return {id: [(sentence, module), ...]} of all notes that the code can give."""
    found: dict[str, list[tuple[str, str]]] = {}
    for package in PACKAGES:
        root = Path(str(files(package)))
        for file in sorted(root.rglob("*.py")):
            module = ".".join((package, *file.relative_to(root).with_suffix("").parts)).removesuffix(".__init__")
            for name, text in _notes_of(ast.parse(file.read_text("utf-8"))):
                if (text, module) not in (known := found.setdefault(name, [])):
                    known.append((text, module))
    return found


def _notes_of(tree: ast.Module) -> Iterator[tuple[str, str]]:
    """Yield id and sentence of each note that a module makes."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == CLASS and len(node.args) == 2:  # noqa: PLR2004 - id and text
            for name in _ids(node.args[0]):
                yield name, _sentence(node.args[1])


def _ids(node: ast.expr) -> Iterator[str]:
    """Yield the ids that an expression may have."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        yield node.value
    elif isinstance(node, ast.IfExp):
        yield from _ids(node.body)
        yield from _ids(node.orelse)


def _sentence(node: ast.expr) -> str:
    """Return a sentence as it is written, with a mark for each part that a run fills in."""
    if isinstance(node, ast.Constant):
        return str(node.value)
    if isinstance(node, ast.JoinedStr):
        return "".join(_sentence(part) for part in node.values)
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
        return _sentence(node.left) + _sentence(node.right)
    if isinstance(node, ast.IfExp):
        return f"{_sentence(node.body)} / {_sentence(node.orelse)}"
    return GIVEN

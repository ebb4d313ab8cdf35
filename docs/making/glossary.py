"""The glossary: every term, verdict and fault that ``imuwb explain`` knows, each with its anchor."""

from pathlib import Path

from imuwb.explanations import anchor_of, explanations
from making.markdown import index


def make(folder: Path) -> None:
    """Write a page for each group of terms."""
    groups: dict[str, list[str]] = {}
    for one in dict.fromkeys(explanations().values()):
        also = f"*Also: {', '.join(one.also)}.*\n\n" if one.also else ""
        groups.setdefault(one.group, []).append(f"(term-{one.anchor})=\n## {one.name}\n\n{also}{one.text}\n")
    names = {group: anchor_of(group) for group in groups}
    for group, parts in groups.items():
        (folder / f"{names[group]}.md").write_text(f"# {group}\n\n" + "\n".join(parts), "utf-8")
    index(
        folder, "Glossary", "Every term, verdict and fault that imuwb prints, in plain words: the same as `imuwb explain TERM`.", names.values()
    )  # fmt: skip

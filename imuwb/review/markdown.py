"""Tables and captions as Markdown, in which no character of a text is read as markup."""

from imuwb.analysis import Table
from imuwb.scene import Caption
from imuwb.texts import printable

MARKUP = str.maketrans({c: f"\\{c}" for c in "|*_`<>[]~$\\"})


def markdown(table: Table) -> str:
    """Return a table and its caption as Markdown."""
    head = (" | ".join(map(literal, table.headings)), " | ".join("---" for _ in table.headings))
    lines = [f"| {row} |" for row in (*head, *(" | ".join(map(literal, row)) for row in table.rows))]
    return "\n".join(lines) + (f"\n\n{literal(table.caption)}" if table.caption else "")


def caption_text(caption: Caption) -> str:
    """Return a caption as Markdown; the first row of its table is in bold."""
    parts = [f"### {literal(caption.title)}", *map(literal, caption.texts)]
    if caption.rows:
        rows = [[literal(cell) for cell in row] for row in caption.rows]
        rows[0] = [f"**{cell}**" if cell else "" for cell in rows[0]]
        head = [[literal(cell) for cell in caption.headings], ["---"] * len(caption.headings)]
        parts.append("\n".join(f"| {' | '.join(row)} |" for row in (*head, *rows)))
    return "\n\n".join((*parts, *map(literal, caption.remarks)))


def literal(text: str) -> str:
    """Return a text in which no character is read as markup, and which has only characters that can be shown."""
    return printable(text).translate(MARKUP)

"""Tables and captions as Markdown, in which no character of a text is read as markup."""

from imuwb.analysis import Table
from imuwb.scene import Caption
from imuwb.texts import markdown_text


def markdown(table: Table) -> str:
    """Return a table and its caption as Markdown."""
    head = (" | ".join(map(markdown_text, table.headings)), " | ".join("---" for _ in table.headings))
    lines = [f"| {row} |" for row in (*head, *(" | ".join(map(markdown_text, row)) for row in table.rows))]
    return "\n".join(lines) + (f"\n\n{markdown_text(table.caption)}" if table.caption else "")


def caption_text(caption: Caption) -> str:
    """Return a caption as Markdown; the first row of its table is in bold."""
    parts = [f"**{markdown_text(caption.title)}**", *map(markdown_text, caption.texts)]
    if caption.rows:
        rows = [[markdown_text(cell) for cell in row] for row in caption.rows]
        rows[0] = [f"**{cell}**" if cell else "" for cell in rows[0]]
        head = [[markdown_text(cell) for cell in caption.headings], ["---"] * len(caption.headings)]
        parts.append("\n".join(f"| {' | '.join(row)} |" for row in (*head, *rows)))
    return "\n\n".join((*parts, *map(markdown_text, caption.remarks)))

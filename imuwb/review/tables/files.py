"""Tables as files for papers and programs: CSV, LaTeX and Markdown. Units are in the headings."""

import csv
import io
import re
import unicodedata

from imuwb.analysis import Table
from imuwb.review.tables.columns import columns_of, parts_of

LATEX = {
    "\\": r"\textbackslash{}", "{": r"\{", "}": r"\}", "&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#", "_": r"\_",
    "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "<": r"$<$", ">": r"$>$", "|": r"$|$", '"': "''", "²": "$^2$", "³": "$^3$",
    "°": r"$^\circ$", "µ": r"$\mu$", "μ": r"$\mu$", "±": r"$\pm$", "×": r"$\times$", "·": r"$\cdot$", "—": "---", "–": "--", "…": r"\dots{}",
    "√": r"$\surd$", "σ": r"$\sigma$", "τ": r"$\tau$", "π": r"$\pi$", "≤": r"$\leq$", "≥": r"$\geq$", "≈": r"$\approx$", "−": "$-$", "∞": r"$\infty$",
    "→": r"$\to$", "\N{NO-BREAK SPACE}": "~",
}  # fmt: skip
_FORMULA = re.compile(r"(√[A-Za-z]+|\^[-\d.]+)")  #: a root, a power
_SAFE = range(0x20, 0x17F)  # letters that LaTeX knows in UTF-8
_MARKUP = re.compile(r"([\\`*_{}\[\]<>|#~$])")


def csv_text(table: Table) -> str:
    """Return a table as CSV: a value, the ends of its interval and, where a column has several units, the unit in columns of their own.

    An upper limit has no value, only an upper end.
    """
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    parts = list(parts_of(table))
    writer.writerow([part.heading for part in parts])
    writer.writerows(zip(*(part.cells for part in parts), strict=True))
    return file.getvalue()


def latex_text(table: Table) -> str:
    """Return a table as a LaTeX table without packages, to be read with input."""
    columns = columns_of(table)
    kinds = "".join("l" if column.quantities is None else "r" for column in columns)
    rows = zip(*(column.cells for column in columns), strict=True)
    lines = [
        r"\begin{table}", r"\centering", rf"\caption{{{_latex(table.title)}}}", rf"\begin{{tabular}}{{{kinds}}}", r"\hline",
        f"{' & '.join(_latex(column.heading) for column in columns)} \\\\", r"\hline",
        *(f"{' & '.join(map(_latex_cell, row))} \\\\" for row in rows), r"\hline", r"\end{tabular}",
        *([rf"\par\footnotesize {_latex(table.caption)}"] if table.caption else []), r"\end{table}", "",
    ]  # fmt: skip
    return "\n".join(lines)


def markdown_text(table: Table) -> str:
    """Return a table as Markdown."""
    columns = columns_of(table)
    rows = [[column.heading for column in columns], *zip(*(column.cells for column in columns), strict=True)]
    lines = [f"| {' | '.join(map(_markdown, row))} |" for row in rows]
    rule = f"| {' | '.join('---' if column.quantities is None else '---:' for column in columns)} |"
    caption = ["", _markdown(table.caption)] if table.caption else []
    return "\n".join([f"**{_markdown(table.title)}**", "", lines[0], rule, *lines[1:], *caption, ""])


#: format -> suffix of its files, and its text of a table
TABLE_FORMATS = {"csv": (".csv", csv_text), "latex": (".tex", latex_text), "md": (".md", markdown_text)}


def _latex_cell(text: str) -> str:
    """Return a cell; one that begins with a bracket is no option of the row before it."""
    return f"{{}}{_latex(text)}" if text[:1] in "[*" and text else _latex(text)


def _latex(text: str) -> str:
    """Return a text as LaTeX prints it, with pdfLaTeX too; a letter that it may not have is named by its code."""
    return "".join(
        _formula(part) if i % 2 else "".join(map(_letter, part)) for i, part in enumerate(_FORMULA.split(text))
    )


def _formula(text: str) -> str:
    return rf"$\sqrt{{\mathrm{{{text[1:]}}}}}$" if text[0] == "√" else f"$^{{{text[1:]}}}$"


def _letter(letter: str) -> str:
    if letter in LATEX:
        return LATEX[letter]
    if ord(letter) in _SAFE:
        return letter
    plain = unicodedata.normalize("NFKD", letter)
    return plain if plain.isascii() and plain.isprintable() else f"[U+{ord(letter):04X}]"


def _markdown(text: str) -> str:
    """Return a text in which no character is read as markup."""
    return _MARKUP.sub(r"\\\1", text)

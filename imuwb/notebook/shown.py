"""The tables and figures of a result: they show themselves in a notebook, and give what they show."""

import html
from typing import Any

from imuwb.analysis import Figure, Series, Table
from imuwb.errors import UsageError
from imuwb.review.page.canvas import Drawing
from imuwb.review.page.pictures import title_of
from imuwb.review.tables.columns import parts_of


class TableFrame:
    """A table of a result: it shows itself in a notebook, and gives its cells as columns."""

    def __init__(self, table: Table) -> None:
        """Take a table as it was drawn."""
        self.table = table

    @property
    def title(self) -> str:
        """The title."""
        return self.table.title

    @property
    def columns(self) -> dict[str, list[Any]]:
        """The columns of the CSV file: numbers where all cells are numbers; ends of intervals, and units that differ, on their own."""
        return {
            part.heading: [_number(cell) for cell in part.cells] if part.numbers else list(part.cells)
            for part in parts_of(self.table)
        }

    def to_pandas(self) -> Any:  # noqa: ANN401 - pandas is an optional package
        """Return the columns as a pandas.DataFrame.

        Raises:
            UsageError: pandas is not installed.
        """
        try:
            import pandas as pd  # noqa: PLC0415 - an optional package
        except ImportError as error:
            raise UsageError(
                "to_pandas needs pandas: pip install pandas, or use columns, or to_arrow with pyarrow"
            ) from error
        return pd.DataFrame(self.columns)

    def to_arrow(self) -> Any:  # noqa: ANN401 - pyarrow has no types
        """Return the columns as a pyarrow.Table."""
        import pyarrow as pa  # noqa: PLC0415 - slow to import

        return pa.table(self.columns)

    def __repr__(self) -> str:
        """Return the rows, a line each."""
        return "\n".join(" | ".join(row) for row in (self.table.headings, *self.table.rows))

    def _repr_html_(self) -> str:
        head = "".join(f"<th>{html.escape(cell)}</th>" for cell in self.table.headings)
        rows = "".join(
            f"<tr>{''.join(f'<td>{html.escape(cell)}</td>' for cell in row)}</tr>" for row in self.table.rows
        )
        caption = html.escape(f"{self.table.title}. {self.table.caption}".strip())
        return f"<table><caption>{caption}</caption><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"


class Picture:
    """A figure, a series or tracks of a result: it shows itself in a notebook, and gives what was drawn."""

    def __init__(self, tab: str, drawing: Drawing) -> None:
        """Take what was drawn on a tab."""
        self.tab, self.drawing = tab, drawing

    @property
    def title(self) -> str:
        """The title."""
        return title_of(self.drawing)

    def __repr__(self) -> str:
        """Return kind and title."""
        kind = (
            "Figure" if isinstance(self.drawing, Figure) else "Series" if isinstance(self.drawing, Series) else "Tracks"
        )
        return f"<{kind}: {self.title}>"

    def _repr_svg_(self) -> str:
        from imuwb.review.page.html import svg_of  # noqa: PLC0415 - matplotlib takes half a second

        return svg_of(self.drawing, f"n{id(self):x}-")


def _number(text: str) -> float:
    return float(text) if text else float("nan")

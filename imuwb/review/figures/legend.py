"""The legend of a figure: the names of its curves, and its marks with their values; it has a margin of its own."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from imuwb.analysis import Curve, Figure, Mark
from imuwb.colors import INK, Color
from imuwb.review.figures.sizes import text_width

#: styles that curves of several colours share; the legend shows these styles in the colour of text
BACKGROUND_STYLES = ("fit", "faint")
SAMPLE, GAP = 26.0, 10.0  #: length of a sample of a line; distance from it to its text
STEP, LEAST_STEP = 22.0, 15.5  #: distance between rows
LEAST_TEXT = 80.0  #: width, of the text that says how many rows are missing
MOST_SHARE = 0.42  #: of a view's width; longer texts are cut
MOST_ABOVE = 4  #: rows above a frame


@dataclass(frozen=True, slots=True)
class Entry:
    """A row of a legend."""

    text: str
    color: Color
    style: str  #: of the curve; "mark" for a mark; empty: only the text


def entries(figure: Figure) -> tuple[Entry, ...]:
    """Return the rows of the legend: curves, then styles that curves share, then marks.

    Marks that all have one colour have numbers, which stand at their points too.
    """
    named = sorted((curve for curve in figure.curves if curve.label), key=lambda c: c.style in BACKGROUND_STYLES)
    lines = [Entry(c.label, _color(c, figure.curves), c.style) for c in named]
    numbers = numbered(figure.marks)
    marks = [
        Entry(" ".join(part for part in (number, mark.text, mark.value) if part), mark.color, "mark")
        for number, mark in zip(numbers, figure.marks, strict=True)
    ]
    return (*lines, *marks)


def in_group(figure: Figure, group: Sequence[Figure]) -> tuple[Entry, ...]:
    """Return the rows of the legend of a figure of a group: the first names the curves, and each its own marks."""
    rows = entries(figure)
    return rows if figure is group[0] else tuple(row for row in rows if row.style == "mark")


def _color(curve: Curve, curves: Sequence[Curve]) -> Color:
    """Return the colour of a curve, or that of text if it names the curves of several colours that have its style."""
    if curve.style not in BACKGROUND_STYLES:
        return curve.color
    others = {other.color for other in curves if other.style == curve.style and not other.label}
    return INK if others - {curve.color} else curve.color


def numbered(marks: Sequence[Mark]) -> tuple[str, ...]:
    """Return a number for each mark; empty texts if colours tell the marks apart."""
    if len(marks) < 2 or len({mark.color for mark in marks}) > 1:  # noqa: PLR2004 - two to be told apart
        return ("",) * len(marks)
    return tuple(str(i + 1) for i in range(len(marks)))


def width(rows: Sequence[Entry], view: float) -> float:
    """Return the width of the margin that a legend needs in a view of a width."""
    if not rows:
        return 0.0
    longest = max(LEAST_TEXT, *(text_width(row.text) for row in rows))
    return min(longest + SAMPLE + 3 * GAP, MOST_SHARE * view)


def fitting(rows: Sequence[Entry], height: float, width: float) -> Iterator[tuple[float, Entry]]:
    """Yield the heights below the top, and the rows that fit; the last of them says how many more there are."""
    most = max(int(height / LEAST_STEP), 1)
    shown = list(rows)
    if len(rows) > most:
        shown = [*rows[: most - 1], Entry(f"and {len(rows) - most + 1} more", INK, "")]
    step = min(STEP, height / len(shown)) if shown else STEP
    for i, row in enumerate(shown):
        text = cut(row.text, width - SAMPLE - 3 * GAP + 1.0) if row.style else row.text
        yield step * (i + 0.5), Entry(text, row.color, row.style)


def wrapped(rows: Sequence[Entry], width: float) -> list[list[tuple[float, Entry]]]:
    """Return the rows of a legend above a frame: in each, the place from the left and the entry; the last entry says how many more there are."""
    found: list[list[tuple[float, Entry]]] = [[]]
    at = 0.0
    for place, entry in enumerate(rows):
        step = SAMPLE + 3 * GAP + text_width(entry.text)
        more = Entry(f"and {len(rows) - place} more", INK, "")
        if found[-1] and at + step > width and len(found) < MOST_ABOVE:
            found.append([])
            at = 0.0
        needed = step if place == len(rows) - 1 else step + SAMPLE + 3 * GAP + text_width(more.text)
        if len(found) == MOST_ABOVE and at + needed > width:
            found[-1].append((at, more))
            break
        found[-1].append((at, entry))
        at += step
    return found if rows else []


def cut(text: str, width: float) -> str:
    """Return a text of at most that width; the last letter shows that it is cut."""
    if text_width(text) <= width:
        return text
    while text and text_width(text) + 8 > width:
        text = text[:-1]
    return f"{text.rstrip()}…"

"""Pictures of a study's tables: how often the intervals contain the truth, against the 95 % that they state."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from imuwb.colors import color_at

SHARE = re.compile(r"^([\d.]+) % \(([\d.]+)–([\d.]+)\)$")  #: a share with its own interval, as studies print it
MEANT = re.compile(r"coverage|the truth", re.IGNORECASE)  #: in the title of a table or the heading of a column
STATED = 95.0  #: %, level of the studies' intervals
GOALS = "Goals"
LABELS = 2  #: first cells of a row that name it
NUMBER = re.compile(r"[-\d.]+(e[-+]?\d+)?")
ROW, FEWEST_LINES, MOST_LINES = 0.3, 4, 42  #: ROW: inch, height of a row; lines of a table with its headings


@dataclass(frozen=True, slots=True)
class Shares:
    """The shares of one table: a series for each column, a row for each label."""

    title: str
    labels: tuple[str, ...]
    series: dict[str, tuple[tuple[float, float, float] | None, ...]]  #: heading -> (share, low, high) of each row, %


def with_pictures(text: str, folder: Path, stem: str) -> str:
    """Return the text of a study with a picture after each table of coverage; the pictures are written into the folder."""
    begin, *sections = re.split(r"^(?=## )", text, flags=re.MULTILINE)
    parts = [begin]
    for i, section in enumerate(sections):
        parts.append(section)
        shares = shares_of(section)
        if shares is not None:
            name = f"{stem}-{i}.svg"
            draw(shares).savefig(folder / name, facecolor="white")
            parts.append(
                f"```{{figure}} {name}\n:alt: {shares.title}: a point and an interval for each row\n\n{shares.title}. The line is {STATED:g} %.\n```\n\n"
            )
    return "".join(parts)


def shares_of(section: str) -> Shares | None:
    """Return the shares of a section's table; None if it has none that count intervals with the truth."""
    title = section.splitlines()[0].removeprefix("## ")
    rows = [
        [cell.strip() for cell in line.strip().strip("|").split(" | ")]
        for line in section.splitlines()
        if line.startswith("|")
    ]
    if title == GOALS or not FEWEST_LINES <= len(rows) <= MOST_LINES:
        return None
    headings, body = rows[0], rows[2:]
    series = {
        heading: found
        for place, heading in enumerate(headings)
        if (MEANT.search(title) or MEANT.search(heading)) and any(found := tuple(_shares(body, place)))
    }
    if not series:
        return None
    first = min(headings.index(heading) for heading in series)
    shown = [i for i in range(len(body)) if any(found[i] for found in series.values())]
    return Shares(
        title, tuple(_label(body[i][: min(first, LABELS)]) for i in shown),
        {heading: tuple(found[i] for i in shown) for heading, found in series.items()},
    )  # fmt: skip


def _shares(body: list[list[str]], place: int) -> Iterator[tuple[float, float, float] | None]:
    for row in body:
        found = SHARE.match(row[place]) if place < len(row) else None
        yield (float(found[1]), float(found[2]), float(found[3])) if found else None


def _label(cells: list[str]) -> str:
    """Return the name of a row: its first cell, and the next ones that are no numbers."""
    return ", ".join([*cells[:1], *(cell for cell in cells[1:] if not NUMBER.fullmatch(cell))])


def draw(shares: Shares) -> Figure:
    """Draw a point with its interval for each share, and a line at the level that is stated."""
    figure = Figure(figsize=(6.5, 1.1 + ROW * max(len(shares.labels), len(shares.series))), layout="constrained")
    axes = figure.subplots()
    axes.axvline(STATED, color="#808088", linewidth=1)
    for i, (heading, found) in enumerate(shares.series.items()):
        rows = np.array([row for row, share in enumerate(found) if share])
        value, low, high = np.array([share for share in found if share]).T
        place = rows + 0.6 * ((i + 0.5) / len(shares.series) - 0.5)
        color = tuple(part / 255 for part in color_at(i))
        axes.errorbar(value, place, xerr=(value - low, high - value), fmt="o", markersize=4, color=color, label=heading)
    axes.set_yticks(range(len(shares.labels)), shares.labels, fontsize=9)
    axes.set_xlabel("intervals that contain the truth [%], each share with its 95 % interval", fontsize=9)
    axes.invert_yaxis()
    axes.grid(axis="x", color="#e4e4e8")
    if len(shares.series) > 1:
        axes.legend(fontsize=8, loc="center left", bbox_to_anchor=(1, 0.5))
    return figure

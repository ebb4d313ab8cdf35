"""Checks what a plugin draws, so that a mistake is an error with a remedy and no blank chart."""

from dataclasses import is_dataclass
from typing import Any, cast

import numpy as np

from imuwb.analysis import Curve, Figure, Series, Table
from imuwb.review.drawn.calls import Item, Track


def check(item: Item) -> None:
    """Check one call of a review.

    Raises:
        ValueError: lengths that differ, a cell or a note that is no text; the message names the place, the rule and the remedy.
    """
    if isinstance(item, Figure):
        for i, curve in enumerate(item.curves):
            _check_curve(curve, f"figure {item.title!r}, curve {curve.label or i + 1!r}")
    elif isinstance(item, Series):
        _check_series(item)
    elif isinstance(item, Table):
        _check_table(item)
    elif isinstance(item, Track):
        if np.ndim(item.position) != 2 or np.shape(item.position)[1] != 3:  # noqa: PLR2004 - latitude, longitude, height
            raise ValueError(
                f"track {item.name!r}: position has the shape {np.shape(item.position)}; give (n, 3): latitude rad, longitude rad, height m"
            )
    elif not isinstance(item, str) and not is_dataclass(cast("Any", item)):
        raise ValueError(f"the note {item!r} is no text; format it, with its unit")


def _check_curve(curve: Curve, place: str) -> None:
    for name in ("x", "y", "lower", "upper"):
        values = getattr(curve, name)
        if values is None:
            continue
        if np.ndim(values) != 1:
            raise ValueError(f"{place}: {name} has the shape {np.shape(values)}; give one number for each point, (n,)")
        if len(values) != len(curve.x):
            raise ValueError(
                f"{place}: x has {len(curve.x)} points and {name} has {len(values)}; give both for each point"
            )


def _check_series(series: Series) -> None:
    place, shape = f"series {series.title!r}", np.shape(series.values)
    if len(shape) != 2 or shape[0] != np.size(series.time):  # noqa: PLR2004 - rows and columns
        raise ValueError(
            f"{place}: time has {np.size(series.time)} rows and values has the shape {shape}; give values (n, k) with a row for each time"
        )
    for name, given in (("names", series.names), ("colors", series.colors or series.names)):
        if len(given) != shape[1]:
            raise ValueError(
                f"{place}: values has {shape[1]} columns and {name} has {len(given)}; give one for each column"
            )


def _check_table(table: Table) -> None:
    for row, cells in enumerate(table.rows, 1):
        place = f"table {table.title!r}, row {row}"
        if len(cells) > len(table.headings):
            raise ValueError(
                f"{place}: it has {len(cells)} cells, and there are {len(table.headings)} headings; give one for each cell"
            )
        for cell, heading in zip(cast("tuple[object, ...]", cells), table.headings, strict=False):
            if not isinstance(cell, str):
                raise ValueError(  # noqa: TRY004 - as the other checks
                    f"{place}, column {heading!r}: {cell!r} is of the type {type(cell).__qualname__}; a cell is a text: format it, as in "
                    "f'{value:.3g} m/s²'"
                )

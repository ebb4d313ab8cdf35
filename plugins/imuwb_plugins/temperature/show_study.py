"""What a person sees of a study over temperature."""

from __future__ import annotations

from typing import TYPE_CHECKING

from imuwb_plugins.temperature import figures, tables

if TYPE_CHECKING:
    from imuwb.analysis import Review
    from imuwb_plugins.temperature.result import Study

SHOWN = ("gyro_y", "accel_y")  #: the paper's axes; figures of the others would crowd the tab


def draw(result: Study, review: Review) -> None:
    """Show AR(1) by temperature and by setting."""
    axes = list(dict.fromkeys(axis for case in result.cases for axis in case.axes))
    for axis in [a for a in SHOWN if a in axes] or axes[:2]:
        review.figure(figures.study(result, axis))
    for axis in axes:
        review.table(tables.study(result, axis))

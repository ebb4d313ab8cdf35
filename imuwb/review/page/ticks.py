"""The ticks of a canvas: few, labelled, and without formulas, so that each label is one plain text."""

import math
from typing import Any

from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullLocator

from imuwb.analysis import AxisScale

PLAIN = (1e-3, 1e4)  #: powers of ten that are written as numbers
FEW = 1.6  #: decades; a shorter axis has ticks at 2 and 5 too
ONE = 0.6  #: decades; a shorter axis has evenly spaced ticks
SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def put_ticks(axes: Any, scales: tuple[AxisScale, AxisScale]) -> None:  # noqa: ANN401 - matplotlib has no types
    """Put ticks on both axes, whose scales are given. A logarithmic axis shorter than two decades has more than one tick."""
    for axis, scale, limits in zip((axes.xaxis, axes.yaxis), scales, (axes.get_xlim(), axes.get_ylim()), strict=True):
        axis.set_minor_locator(NullLocator())
        if scale != "log":
            whole = scale == "whole"
            axis.set_major_locator(MaxNLocator(7, steps=[1, 2, 5, 10] if whole else [1, 2, 2.5, 5, 10], integer=whole))
            continue
        decades = math.log10(max(limits) / min(limits)) if min(limits) > 0 else 1.0
        locator = LogLocator(10, subs=(1.0, 2.0, 5.0) if decades < FEW else (1.0,), numticks=9)
        axis.set_major_locator(MaxNLocator(5) if decades < ONE else locator)
        axis.set_major_formatter(FuncFormatter(_labelled))


def _labelled(value: float, _: int | None) -> str:
    return number(value)


def number(value: float) -> str:
    """Return a number of a logarithmic axis: 0.01, 5, 1000, 10⁵, 2·10⁻⁴."""
    if value <= 0 or PLAIN[0] <= value < PLAIN[1]:
        return f"{value:.6g}"
    power = math.floor(math.log10(value) + 1e-9)
    factor = f"{value / 10.0**power:.4g}"
    return f"{'' if factor == '1' else f'{factor}·'}10{str(power).translate(SUPERSCRIPT)}"

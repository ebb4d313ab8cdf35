"""The colours of every figure, series, table and track, toned for dark and light backgrounds (after Tableau's ten)."""

from typing import TypeAlias

Color: TypeAlias = tuple[int, int, int]

BLUE: Color = (76, 120, 168)
ORANGE: Color = (242, 142, 43)
GREEN: Color = (84, 162, 75)
RED: Color = (228, 87, 86)
PURPLE: Color = (176, 122, 161)
TEAL: Color = (118, 183, 178)
YELLOW: Color = (237, 201, 72)
BROWN: Color = (156, 117, 95)
PINK: Color = (255, 157, 167)

INK: Color = (225, 225, 228)  #: text, and the curve that others are compared with
PALE: Color = (200, 200, 205)  #: bands and dashed lines
GREY: Color = (150, 150, 156)  #: things of less importance
#: the frame of a figure, its labelled grid lines, its other grid lines
FRAME, GRID, SUBGRID = GREY, (105, 105, 112), (58, 58, 64)
BACKGROUND: Color = (22, 22, 26)  #: the background of figures and tracks

#: One colour for each axis.
AXIS_COLORS: dict[str, Color] = {"x": RED, "y": GREEN, "z": BLUE}
#: The tracks of GNSS receivers.
TRACK_COLORS: tuple[Color, ...] = (ORANGE, TEAL, PURPLE)
#: Colours of things without an order.
PALETTE: tuple[Color, ...] = (BLUE, ORANGE, GREEN, RED, PURPLE, TEAL, YELLOW, BROWN)


def color_at(index: int) -> Color:
    """Return the colour of the ``index``-th of many things; after the last colour of the palette, the first one follows."""
    return PALETTE[index % len(PALETTE)]


def between(first: Color, second: Color, share: float) -> Color:
    """Return the colour that lies that share of the way from the first to the second."""
    r, g, b = (round((1 - share) * a + share * z) for a, z in zip(first, second, strict=True))
    return r, g, b

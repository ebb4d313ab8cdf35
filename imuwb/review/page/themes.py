"""The colours of pages, for a light and a dark background, and for paper. A curve can be told from its background."""

from imuwb.colors import FRAME, INK, PALE, Color, between
from imuwb.review.page.canvas import Look

CONTRAST = 3.0  #: least ratio of luminances of a curve and its background (WCAG 2, 1.4.11)
LIGHT, DARK = (255, 255, 255), (22, 22, 26)  #: backgrounds
BLACK: Color = (28, 28, 32)
WIDTH, FONT = 7.2, 9.0  #: inches and points of figures on a page
PAPER_WIDTH, PAPER_FONT = 6.5, 9.0  #: of figures for a paper: the width of its text
STEPS = 40
#: Names that stand for the page's own colours in a drawing, where matplotlib wants colours.
INK_NAME, GRID_NAME = "#010203", "#040506"


def contrast(first: Color, second: Color) -> float:
    """Return the ratio of the luminances of two colours, 1 to 21 (WCAG 2)."""
    low, high = sorted((_luminance(first), _luminance(second)))
    return (high + 0.05) / (low + 0.05)


def readable(color: Color, background: Color) -> Color:
    """Return a colour, or the nearest one towards black or white that can be told from a background."""
    end = BLACK if _luminance(background) > 0.5 else INK  # noqa: PLR2004 - the middle
    steps = (between(color, end, step / STEPS) for step in range(STEPS + 1))
    return next((c for c in steps if contrast(c, background) >= CONTRAST), end)


def text_of(color: Color) -> str:
    """Return a colour as #rrggbb."""
    return "#{:02x}{:02x}{:02x}".format(*color)


def color_of(text: str) -> Color:
    """Return the colour that #rrggbb states."""
    return int(text[1:3], 16), int(text[3:5], 16), int(text[5:7], 16)


def on_page(color: Color) -> str:
    """Return the colour of a curve on a page, whose final colour the style sheet states."""
    return INK_NAME if color in (INK, PALE) else text_of(color)


def on_paper(color: Color) -> str:
    """Return the colour of a curve on white paper."""
    return text_of(BLACK if color == INK else FRAME if color == PALE else readable(color, LIGHT))


PAGE = Look(WIDTH, FONT, INK_NAME, GRID_NAME, on_page)
PRINT = Look(WIDTH, FONT, text_of(BLACK), "#d9d9de", on_paper)
PAPER = Look(PAPER_WIDTH, PAPER_FONT, "#000000", "#d9d9de", on_paper, "#ffffff", 300.0)


def _luminance(color: Color) -> float:
    linear = [c / 255 / 12.92 if c / 255 <= 0.04045 else ((c / 255 + 0.055) / 1.055) ** 2.4 for c in color]  # noqa: PLR2004
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

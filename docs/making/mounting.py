"""The picture of the axes: those of a vehicle, the signs of the angles, and an IMU in four mountings."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from imuwb.arrays import Floats
from imuwb.colors import BLUE, GREEN, RED, Color
from imuwb.geodesy.attitude import rotation_of_euler

#: forward, right, down -> right and up in the picture, seen from behind, left and above
VIEW = np.array([[0.80, 0.62, 0.0], [0.34, -0.36, -0.90]])
CAR = np.array([[1.6, -0.8, 0], [1.6, 0.8, 0], [-1.6, 0.8, 0], [-1.6, -0.8, 0], [1.6, -0.8, 0]])
AXES = tuple(zip("xyz", (RED, GREEN, BLUE), np.eye(3), strict=True))
MOUNTINGS = {
    (0, 0, 0): "as the vehicle",
    (0, 0, 90): "its x points to the right",
    (180, 0, 0): "upside down",
    (0, 30, 0): "its x points up by 30°",
}


class Sign(NamedTuple):
    """What the large vehicle states of an axis."""

    direction: str
    turn: str  #: the positive turn about the axis
    length: float
    offset: tuple[float, float]  #: of the text of the turn, points


SIGNS = (
    Sign("forward", "roll +: right side down", 2.6, (-60, 30)),
    Sign("right", "pitch +: front up", 1.9, (30, -24)),
    Sign("down", "heading +: clockwise from above", 1.7, (-168, -4)),
)


def make(folder: Path) -> None:
    """Draw the picture."""
    figure = Figure(figsize=(5.5, 7.4), layout="constrained")
    parts = figure.subplot_mosaic([["signs", "signs"], ["a", "b"], ["c", "d"]], height_ratios=(1.5, 1, 1))
    _signs(parts["signs"])
    for part, (angles, text) in zip("abcd", MOUNTINGS.items(), strict=True):
        _mounted(parts[part], angles, text)
    figure.savefig(folder / "mounting.svg", facecolor="white")


def _signs(axes: Axes) -> None:
    """Draw the axes of the vehicle with the positive turns about them."""
    _vehicle(axes)
    for (letter, color, direction), sign in zip(AXES, SIGNS, strict=True):
        _arrow(axes, sign.length * direction, color, f"{letter}  {sign.direction}", width=2.2)
        place = "xyz".index(letter)
        first, second = np.eye(3)[(place + 1) % 3], np.eye(3)[(place + 2) % 3]
        turn = np.radians(np.linspace(-150, 110, 60))[:, None]
        circle = 0.7 * sign.length * direction + 0.34 * (np.cos(turn) * first + np.sin(turn) * second)
        axes.plot(*(circle @ VIEW.T).T, color=_rgb(color), linewidth=1.4)
        _line(axes, circle[-3], circle[-1], color, 1.4)
        axes.annotate(
            sign.turn,
            _seen(circle.mean(axis=0)),
            sign.offset,
            textcoords="offset points",
            color=_rgb(color),
            fontsize=9,
        )
    axes.set_title("Axes of a vehicle (FRD), and the signs of the angles", fontsize=10)
    _frame(axes, 2.7)


def _mounted(axes: Axes, angles: tuple[int, int, int], text: str) -> None:
    """Draw the axes of an IMU in the vehicle."""
    _vehicle(axes)
    turned = rotation_of_euler(np.radians(angles))
    for letter, color, direction in AXES:
        _arrow(axes, 1.5 * turned @ direction, color, letter, width=1.8)
    axes.set_title(f"--mounting {','.join(map(str, angles))}\n{text}", fontsize=9)
    _frame(axes, 2.0)


def _vehicle(axes: Axes) -> None:
    outline = CAR @ VIEW.T
    axes.fill(*outline.T, facecolor="#ececf0", edgecolor="#a0a0a8")
    nose = np.array([[1.2, -0.5, 0], [1.5, 0, 0], [1.2, 0.5, 0]]) @ VIEW.T
    axes.plot(*nose.T, color="#a0a0a8")


def _arrow(axes: Axes, end: Floats, color: Color, text: str, *, width: float) -> None:
    """Draw an arrow from the origin with its name."""
    _line(axes, np.zeros(3), end, color, width)
    right, up = _seen(1.08 * end)
    axes.text(
        right,
        up,
        text,
        color=_rgb(color),
        ha="left" if right >= 0 else "right",
        va="center",
        fontsize=10,
        fontweight="bold",
    )


def _line(axes: Axes, begin: Floats, end: Floats, color: Color, width: float) -> None:
    axes.annotate(
        "", _seen(end), _seen(begin), arrowprops={"arrowstyle": "-|>", "color": _rgb(color), "linewidth": width}
    )


def _seen(point: Floats) -> tuple[float, float]:
    """Return where a point of forward, right, down is in the picture."""
    right, up = VIEW @ point
    return float(right), float(up)


def _frame(axes: Axes, size: float) -> None:
    axes.set(xlim=(-size, size), ylim=(-0.85 * size, 0.85 * size), aspect="equal")
    axes.set_axis_off()


def _rgb(color: Color) -> tuple[float, float, float]:
    r, g, b = (value / 255 for value in color[:3])
    return r, g, b

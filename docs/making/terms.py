"""Figures of the explanation: the same three sensors in time, by frequency, and as Allan curves."""

from pathlib import Path

import numpy as np

from imuwb.analysis import Curve, Figure
from imuwb.colors import BLUE, GREEN, RED
from imuwb.identification import allan, power_spectrum
from imuwb.review.page.canvas import render
from imuwb.review.page.themes import PAPER
from imuwb.stochastic import FlickerNoise, RandomWalk, WhiteNoise

RATE, HOURS = 20.0, 2.0
DEG = np.pi / 180
TERMS = {
    "N = 2 deg/√h": (WhiteNoise(2 * DEG / 60), BLUE),
    "B = 40 deg/h": (FlickerNoise(40 * DEG / 3600), GREEN),
    "K = 400 deg/h^1.5": (RandomWalk(400 * DEG / 60**3), RED),
}


def make(folder: Path) -> None:
    """Write the figures, and the text that shows them."""
    n, dt = round(HOURS * 3600 * RATE), 1 / RATE
    series = {
        name: (process.sample(n, dt, np.random.default_rng(i)) / DEG * 3600, color)
        for i, (name, (process, color)) in enumerate(TERMS.items())
    }
    time = np.arange(n) * dt / 3600
    shown = slice(None, None, 40)
    figures = {
        "time": Figure(
            "In time", "time [h]", "rate [deg/h]",
            tuple(Curve(name, time[shown], x[shown], c, style="curve") for name, (x, c) in series.items()),
            x_scale="linear", y_scale="linear",
        ),
        "frequency": Figure(
            "By frequency", "frequency [Hz]", "one-sided density [(deg/h)²/Hz]",
            tuple(_spectrum(name, x, c) for name, (x, c) in series.items()),
        ),
        "allan": Figure(
            "As Allan curves", "averaging time [s]", "Allan deviation [deg/h]", tuple(_allan(name, x, c) for name, (x, c) in series.items())
        ),
    }  # fmt: skip
    lines: list[str] = []
    for name, figure in figures.items():
        (folder / f"{name}.svg").write_bytes(render(figure, PAPER, "svg"))
        lines.append(f"```{{figure}} /made/terms/{name}.svg\n:alt: {figure.title}: N, B and K\n\n{figure.title}\n```")
    (folder / "figures.md").write_text("\n\n".join(lines) + "\n", "utf-8")


def _spectrum(name: str, x: np.ndarray, color: tuple[int, int, int]) -> Curve:
    s = power_spectrum(x, 1 / RATE, 1 << 14)
    return Curve(name, s.frequency, s.density, color, style="curve")


def _allan(name: str, x: np.ndarray, color: tuple[int, int, int]) -> Curve:
    curve = allan(x, 1 / RATE)
    return Curve(name, curve.averaging_time, curve.deviation, color, curve.lower, curve.upper)

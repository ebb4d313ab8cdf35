"""What can be asked of a least-squares spectrum."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Literal

MOST_OVERSAMPLING, MOST_PEAKS, MOST_ORDERS = 8, 50, 64


@dataclass(frozen=True)
class Parameters:
    """Options of ``imuwb lssa``."""

    trend: Annotated[
        Literal["none", "constant", "linear", "quadratic"], "known course, estimated together with every line"
    ] = "linear"
    jumps: Annotated[str, "known jumps of level, s from the log's start, with commas between"] = ""
    forced: Annotated[str, "lines known to be there, Hz, with commas between"] = ""
    exponentials: Annotated[str, "time constants of known transients from the log's start on, s"] = ""
    noise: Annotated[
        str,
        "its structure: local (by its neighbours), white, ar:P, gauss-markov, gauss-markov:SECONDS, random-walk, "
        "covariance:FILE.npy",
    ] = "local"
    level: Annotated[float, "of significance, at one frequency and in the whole record"] = 0.99
    confidence: Annotated[float, "of the intervals of lines"] = 0.95
    highest: Annotated[float | None, "highest frequency, Hz; else half the rate"] = None
    oversampling: Annotated[int, "frequencies to each cycle more that the record holds"] = 2
    peaks: Annotated[int, "lines an axis, at most"] = 12
    order: Annotated[int, "of the autoregressive noise that is tested for"] = 1
    scale: Annotated[
        Literal["density", "percent", "decibels", "printed"],
        "what is drawn: unit²/Hz, per cent, or the paper's equations 12 and 13",
    ] = "density"

    def __post_init__(self) -> None:
        """Check the values."""
        for name, least, most in (("oversampling", 1, MOST_OVERSAMPLING), ("peaks", 0, MOST_PEAKS), ("order", 1, 30)):
            value = getattr(self, name)
            if not least <= value <= most:
                message = f"{name} is {value}; it must be {least} to {most}"
                raise ValueError(message)
        for name, least in (("level", 0.5), ("confidence", 0.5)):
            value = getattr(self, name)
            if not least <= value < 1:
                message = f"{name} is {value}; it must be at least {least} and below 1"
                raise ValueError(message)
        if self.highest is not None and not 0 < self.highest < math.inf:
            message = f"highest is {self.highest} Hz; it must be above 0"
            raise ValueError(message)
        self.numbers("jumps", least=-math.inf)
        self.numbers("forced")
        self.numbers("exponentials")
        self.structure()

    def numbers(self, name: str, *, least: float = 0.0) -> tuple[float, ...]:
        """Return the numbers of an option, in its unit.

        Raises:
            ValueError: one that is none, or not above ``least``.
        """
        text: str = getattr(self, name)
        try:
            found = tuple(float(part) for part in text.split(",") if part.strip())
        except ValueError as error:
            message = f"{name} is {text!r}; it must be numbers with commas between, such as 0.5,1.5"
            raise ValueError(message) from error
        if len(set(found)) < len(found):
            message = f"{name} is {text!r}; each must be there once"
            raise ValueError(message)
        if not all(least < x < math.inf for x in found):
            message = f"{name} is {text!r}; each must be {'a number' if least < 0 else f'above {least:g}'}"
            raise ValueError(message)
        return found

    def structure(self) -> tuple[str, int, float | None, str]:
        """Return kind, order, correlation time and file of the noise.

        Raises:
            ValueError: no structure that is known.
        """
        kind, _, rest = self.noise.partition(":")
        try:
            if kind == "ar" and 1 <= int(rest or 1) <= MOST_ORDERS:
                return "autoregressive", int(rest or 1), None, ""
            if kind == "gauss-markov" and (not rest or 0 < float(rest) < math.inf):
                return kind, 0, float(rest) if rest else None, ""
            if kind == "covariance" and rest:
                return kind, 0, None, rest
            if kind in ("local", "white", "random-walk") and not rest:
                return kind, 0, None, ""
        except ValueError:
            pass
        message = (
            f"noise is {self.noise!r}; it must be local, white, ar:P with P from 1 to {MOST_ORDERS}, gauss-markov, gauss-markov:SECONDS, random-walk, "
            "or covariance:FILE.npy"
        )
        raise ValueError(message)

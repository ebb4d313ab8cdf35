"""Options of the least-squares spectrum."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, ClassVar, Literal

from imuwb.options import POSITIVE, Between, Form, Level, check, text_of

MOST_ORDERS = 64


@dataclass(frozen=True, slots=True)
class NoiseOption:
    """The structure of the noise, as a person writes it."""

    FORMS: ClassVar[str] = (
        f"local, white, ar:P with P from 1 to {MOST_ORDERS}, gauss-markov, gauss-markov:SECONDS, random-walk, "
        "or covariance:FILE.npy"
    )

    kind: Literal["local", "white", "autoregressive", "gauss-markov", "random-walk", "covariance"] = "local"
    order: int = 0  #: of autoregressive noise
    correlation_time: float | None = None  #: s, of Gauss-Markov noise; None: it is estimated
    file: Path | None = None  #: array of the covariance

    @classmethod
    def from_text(cls, text: str) -> NoiseOption:
        """Return the structure that a text stands for.

        Raises:
            ValueError: the text stands for none.
        """
        word, _, rest = text.partition(":")
        if word == "ar" and 1 <= int(rest or 1) <= MOST_ORDERS:
            return cls("autoregressive", int(rest or 1))
        if word == "gauss-markov" and (not rest or 0 < float(rest) < math.inf):
            return cls("gauss-markov", correlation_time=float(rest) if rest else None)
        if word == "covariance" and rest:
            return cls("covariance", file=Path(rest))
        if text in ("local", "white", "random-walk"):
            return cls(text)
        raise ValueError

    def __str__(self) -> str:
        """Return the text."""
        if self.kind == "autoregressive":
            return f"ar:{self.order}"
        rest = self.correlation_time if self.file is None else self.file
        return self.kind if rest is None else f"{self.kind}:{rest}"


@dataclass(frozen=True)
class Parameters:
    """Options of ``imuwb lssa``."""

    trend: Annotated[
        Literal["none", "constant", "linear", "quadratic"], "Known trend, estimated together with every line."
    ] = "linear"
    jumps: Annotated[
        tuple[float, ...], "Times of known jumps of the level, from the log's start (s).", Between(), Form("T1,T2,...", "0.5,1.5")
    ] = ()  # fmt: skip
    forced: Annotated[
        tuple[float, ...], "Frequencies of known lines (Hz).", POSITIVE, Form("F1,F2,...", "0.5,1.5")
    ] = ()
    exponentials: Annotated[
        tuple[float, ...], "Time constants of known transients that begin with the log (s).", POSITIVE, Form("T1,T2,...", "10,100")
    ] = ()  # fmt: skip
    noise: Annotated[
        NoiseOption,
        "Structure of the noise: local (estimated around each frequency), white, ar:P, gauss-markov, gauss-markov:SECONDS, "
        "random-walk, covariance:FILE.npy.",
        Form("STRUCTURE", "ar:2"),
    ] = NoiseOption()
    level: Annotated[Level, "Level of significance of lines and of the tests."] = 0.99
    confidence: Annotated[Level, "Level of the intervals of lines and constituents."] = 0.95
    highest: Annotated[float | None, "Highest frequency; default: half the sampling rate (Hz).", POSITIVE] = None
    oversampling: Annotated[int, "Frequencies for each cycle over the record.", Between(1, 8)] = 2
    peaks: Annotated[int, "Largest number of lines of an axis.", Between(0, 50)] = 12
    order: Annotated[int, "Order of the autoregressive noise that is tested.", Between(1, 30)] = 1
    scale: Annotated[
        Literal["density", "percent", "decibels", "printed"],
        "Scale of the figures: unit²/Hz, per cent, or the paper's equations 12 (decibels) and 13 (printed).",
    ] = "density"

    def __post_init__(self) -> None:
        """Check the values."""
        check(self)
        for name in ("jumps", "forced", "exponentials"):
            values = getattr(self, name)
            if len(set(values)) < len(values):
                raise ValueError(f"{name} is {text_of(values)}; give each value only once")

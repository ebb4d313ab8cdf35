"""Result of the noise analysis."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from imuwb.notes import Note
from imuwb.statistics import Coefficient
from imuwb.stochastic import Autoregressive
from imuwb.texts import coefficients_text
from imuwb_plugins.noise.denoising import Denoising
from imuwb_plugins.noise.repeatability import Repeatability

#: tabs in their order: analysis -> title
TITLES = {"allan": "Allan", "psd": "Spectrum", "autocorrelation": "Correlation", "autoregressive": "Autoregression"}


@dataclass(frozen=True, slots=True, repr=False)
class NoiseAxis:
    """All estimates of one axis."""

    headline: str | None  #: estimator whose coefficients the error model takes
    coefficients: Mapping[str, Coefficient]  #: of the headline
    estimators: dict[str, Mapping[str, Coefficient]]  #: estimator -> coefficients
    verdict: tuple[str, ...]  #: all remarks
    remarks: tuple[
        str, ...
    ]  #: of the estimators: the dominant processes first, then those that put the coefficients in doubt
    others: tuple[tuple[str, str], ...]  #: (analysis, remark) of the analyses that estimate no coefficients

    def __repr__(self) -> str:
        """Return the coefficients of the headline."""
        return f"{coefficients_text(self.coefficients)} (by {self.headline})"


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class Result:
    """The results of all analyses."""

    axes: dict[str, NoiseAxis]  #: of the first log
    parts: tuple[dict[str, Any], ...]  #: for each log: analysis -> its own result
    denoising: Denoising | None
    #: of one log, by axis: AR(1) and AR(3) of samples without the details of table 7's levels, for 15AR and 27AR (Quinchia, table 2)
    autoregressive: dict[str, tuple[Autoregressive, ...]]
    repeatability: Repeatability | None  #: comparison of several logs; None: one log
    notes: tuple[Note, ...] = ()

    def __repr__(self) -> str:
        """Return the coefficients of each axis."""
        return "\n".join(f"{axis}: {r}" for axis, r in self.axes.items())

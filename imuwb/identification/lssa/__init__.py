"""Least-squares spectral analysis: periodic lines of unevenly spaced, weighted, coloured series, and the structure of the noise."""

from imuwb.identification.lssa.constituents import TRENDS, Constituents
from imuwb.identification.lssa.drifting import DriftingLine, drifting_lines
from imuwb.identification.lssa.hypotheses import (
    ChiSquare,
    Hypothesis,
    is_autoregressive,
    is_random_walk,
)
from imuwb.identification.lssa.noise import Noise, NoiseFit, NoiseKind
from imuwb.identification.lssa.peaks import Extraction, Peak, extract
from imuwb.identification.lssa.significance import Significance, significance
from imuwb.identification.lssa.spectrum import Adjusted, Spectrum, adjust, least_squares_spectrum
from imuwb.identification.lssa.usable import UsableBand, usable_band

__all__ = [
    "TRENDS", "Adjusted", "ChiSquare", "Constituents", "DriftingLine", "Extraction", "Hypothesis", "Noise",
    "NoiseFit", "NoiseKind", "Peak", "Significance", "Spectrum", "UsableBand", "adjust", "drifting_lines",
    "extract", "is_autoregressive", "is_random_walk", "least_squares_spectrum", "significance",
    "usable_band",
]  # fmt: skip

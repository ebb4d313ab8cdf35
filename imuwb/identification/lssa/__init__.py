"""Least-squares spectral analysis: lines of unevenly spaced, weighted, coloured series, and what noise they stand in."""

from imuwb.identification.lssa.constituents import TRENDS, Constituents
from imuwb.identification.lssa.drifting import DriftingLine, drifting_lines
from imuwb.identification.lssa.hypotheses import ChiSquare, Hypothesis, is_autoregressive, is_random_walk, words
from imuwb.identification.lssa.noise import Kind, Noise, NoiseFit
from imuwb.identification.lssa.peaks import Extraction, Peak, extract
from imuwb.identification.lssa.significance import Significance, significance
from imuwb.identification.lssa.spectrum import Adjusted, Spectrum, adjust, least_squares_spectrum
from imuwb.identification.lssa.usable import UsableBand, usable_band

__all__ = [
    "TRENDS",
    "Adjusted",
    "ChiSquare",
    "Constituents",
    "DriftingLine",
    "Extraction",
    "Hypothesis",
    "Kind",
    "Noise",
    "NoiseFit",
    "Peak",
    "Significance",
    "Spectrum",
    "UsableBand",
    "adjust",
    "drifting_lines",
    "extract",
    "is_autoregressive",
    "is_random_walk",
    "least_squares_spectrum",
    "significance",
    "usable_band",
    "words",
]

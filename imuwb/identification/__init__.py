"""Noise identification: arrays in, frozen results out. No module here knows a file or a viewer."""

from imuwb.identification.allan_variance.averaging import averaging_factors
from imuwb.identification.allan_variance.fit import AllanFit, CorrelationTime, Region, fit_allan
from imuwb.identification.allan_variance.moments import equivalent_degrees_of_freedom
from imuwb.identification.allan_variance.overlapping import AllanDeviation, allan, allan_of_axes
from imuwb.identification.allan_variance.relatives import deviation
from imuwb.identification.correlation.autocorrelation import Autocorrelation, GaussMarkovFit, autocorrelation
from imuwb.identification.correlation.autoregressive import AutoregressiveFit, fit_autoregressive
from imuwb.identification.correlation.burg import Burg, burg
from imuwb.identification.likelihood.cosine_spectrum import CosineSpectrum, cosine_spectrum
from imuwb.identification.likelihood.fit import LikelihoodFit, fit_cosine_spectrum, fit_likelihood, spectrum_without
from imuwb.identification.likelihood.model_choice import Candidate, ModelChoice, choose_model
from imuwb.identification.spectral.lines import Line, find_lines
from imuwb.identification.spectral.spectrum import PowerSpectrum, SpectralFit, fit_spectrum, power_spectrum
from imuwb.identification.stationarity import Stationarity, stationarity
from imuwb.identification.stillness import Disturbance, Stillness, stillness
from imuwb.identification.wavelet_variance import WaveletFit, WaveletVariance, fit_wavelet_variance, wavelet_variance
from imuwb.statistics import Coefficient

__all__ = [
    "AllanDeviation",
    "AllanFit",
    "Autocorrelation",
    "AutoregressiveFit",
    "Burg",
    "Candidate",
    "Coefficient",
    "CorrelationTime",
    "CosineSpectrum",
    "Disturbance",
    "GaussMarkovFit",
    "LikelihoodFit",
    "Line",
    "ModelChoice",
    "PowerSpectrum",
    "Region",
    "SpectralFit",
    "Stationarity",
    "Stillness",
    "WaveletFit",
    "WaveletVariance",
    "allan",
    "allan_of_axes",
    "autocorrelation",
    "averaging_factors",
    "burg",
    "choose_model",
    "cosine_spectrum",
    "deviation",
    "equivalent_degrees_of_freedom",
    "find_lines",
    "fit_allan",
    "fit_autoregressive",
    "fit_cosine_spectrum",
    "fit_likelihood",
    "fit_spectrum",
    "fit_wavelet_variance",
    "power_spectrum",
    "spectrum_without",
    "stationarity",
    "stillness",
    "wavelet_variance",
]

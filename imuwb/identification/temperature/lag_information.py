"""What the noise of one axis leaves to know of the lag of a thermometer."""

from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats
from imuwb.identification.temperature.drift_fit import DriftFit


@dataclass(frozen=True, eq=False, slots=True)
class LagInformation:
    """The information of an axis about the lag, beside which the axis's drift and noise are estimated too."""

    information: float  #: s^-2, the curvature of half the deviance
    own: float  #: s^-2, the part of the axis's own noise in it; the rest is noise of the thermometer
    score: Floats  #: (m,) 1/(s unit), factors of the coefficients in the slope of half the deviance


def lag_information(fit: DriftFit, series: Floats, columns: Floats, along: Floats, blurred: Floats) -> LagInformation:
    """Return the information of an axis about the lag.

    The information with one slow noise is what is left of the derivative beside the columns. A record that does not
    tell its slow noise has less: the variance of the slopes of the slow noises' likelihoods is lost (Louis 1982), and so is what goes
    into the estimate of the white noise.

    Args:
        fit: of the axis.
        series: (m,) its cosine coefficients.
        columns: (m, p) those of the drift's columns.
        along: (m,) derivative of the drift's coefficients by the lag, unit/s.
        blurred: (m,) variances by the noise of the thermometer, the axis's white noise being 1.
    """
    weighted = fit.weight_each * along
    explained = np.einsum("gpq,gq->gp", fit.inverse_each, weighted @ columns) @ columns.T
    score = (weighted - fit.weight_each * explained) / fit.white_each[:, None]
    residual = series - fit.factors_each @ columns.T
    each, slope = score @ along, np.einsum("gm,gm->g", score, residual)
    lost = fit.probability @ (slope - fit.probability @ slope) ** 2 + 2 * fit.probability @ slope**2 / fit.freedom
    variance = fit.white_each[:, None] * (1 / fit.weight_each - blurred)
    own = np.einsum("gm,gm->g", score**2, variance)
    share = float(fit.probability @ own) / float(fit.probability @ each)
    information = float(fit.probability @ each - lost)
    return LagInformation(information, share * information, fit.probability @ score)

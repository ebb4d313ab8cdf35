"""Noise and bias over temperature: set-points, tests of dependence, and functions of temperature."""

from imuwb.identification.temperature.axis import AxisTemperatures, Law, over_temperature
from imuwb.identification.temperature.bias import Bias, Hysteresis, RecordMean
from imuwb.identification.temperature.bias_polynomial import BiasPolynomial, bias_polynomial, polynomial_through
from imuwb.identification.temperature.dependence import Dependence, heterogeneity
from imuwb.identification.temperature.first_order import FirstOrder, first_order
from imuwb.identification.temperature.function_choice import (
    CONTRADICTED,
    FunctionCandidate,
    FunctionChoice,
    choose_function,
)
from imuwb.identification.temperature.functions import KINDS, TemperatureFunction
from imuwb.identification.temperature.model import axis_model
from imuwb.identification.temperature.record import Record
from imuwb.identification.temperature.set_point import SetPoint, log_sigma, set_point_of
from imuwb.identification.temperature.stretches import Stretch, stretches
from imuwb.identification.temperature.thermal_lag import ThermalLag, thermal_lag
from imuwb.identification.temperature.thermal_trend import smooth_temperature
from imuwb.identification.temperature.thermometer_curve import ThermometerCurve, thermometer_curve

__all__ = [
    "CONTRADICTED", "KINDS", "AxisTemperatures", "Bias", "BiasPolynomial", "Dependence", "FirstOrder", "FunctionCandidate", "FunctionChoice",
    "Hysteresis", "Law", "Record", "RecordMean", "SetPoint", "Stretch", "TemperatureFunction", "ThermalLag", "ThermometerCurve", "axis_model", "bias_polynomial",
    "choose_function", "first_order", "heterogeneity", "log_sigma", "over_temperature", "polynomial_through", "set_point_of",
    "smooth_temperature", "stretches", "thermal_lag", "thermometer_curve",
]  # fmt: skip

"""Noise and bias over temperature: set-points, tests of dependence, and functions of temperature."""

from imuwb.identification.temperature.axis import AxisTemperatures, Law, over_temperature
from imuwb.identification.temperature.bias import Bias, Hysteresis, RecordMean
from imuwb.identification.temperature.dependence import Dependence, heterogeneity
from imuwb.identification.temperature.first_order import FirstOrder, first_order
from imuwb.identification.temperature.function_choice import FunctionCandidate, FunctionChoice, choose_function
from imuwb.identification.temperature.functions import KINDS, TemperatureFunction
from imuwb.identification.temperature.model import axis_model
from imuwb.identification.temperature.record import Record
from imuwb.identification.temperature.set_point import SetPoint, log_sigma, set_point_of
from imuwb.identification.temperature.stretches import Stretch, stretches
from imuwb.identification.temperature.thermal_trend import smooth_temperature

__all__ = [
    "KINDS", "AxisTemperatures", "Bias", "Dependence", "FirstOrder", "FunctionCandidate", "FunctionChoice",
    "Hysteresis", "Law", "Record", "RecordMean", "SetPoint", "Stretch", "TemperatureFunction", "axis_model",
    "choose_function", "first_order", "heterogeneity", "log_sigma", "over_temperature", "set_point_of",
    "smooth_temperature", "stretches",
]  # fmt: skip

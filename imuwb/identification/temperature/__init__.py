"""Noise and bias over temperature: set-points, functions of temperature, and whether anything depends on it at all."""

from imuwb.identification.temperature.axis import AxisTemperatures, Law, over_temperature
from imuwb.identification.temperature.bias import Bias, Hysteresis, Mean
from imuwb.identification.temperature.choice import Candidate, Choice, choose_function
from imuwb.identification.temperature.dependence import Dependence, heterogeneity
from imuwb.identification.temperature.first_order import FirstOrder, first_order
from imuwb.identification.temperature.functions import KINDS, TemperatureFunction
from imuwb.identification.temperature.model import axis_model
from imuwb.identification.temperature.record import Record
from imuwb.identification.temperature.set_point import SetPoint, identify, log_sigma
from imuwb.identification.temperature.stretches import Stretch, stretches
from imuwb.identification.temperature.thermal_trend import smooth_temperature

__all__ = [
    "KINDS",
    "AxisTemperatures",
    "Bias",
    "Candidate",
    "Choice",
    "Dependence",
    "FirstOrder",
    "Hysteresis",
    "Law",
    "Mean",
    "Record",
    "SetPoint",
    "Stretch",
    "TemperatureFunction",
    "axis_model",
    "choose_function",
    "first_order",
    "heterogeneity",
    "identify",
    "log_sigma",
    "over_temperature",
    "smooth_temperature",
    "stretches",
]

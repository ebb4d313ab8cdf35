"""Noise identification: arrays in, frozen results out. No module here knows a file or a viewer."""

from imuwb.identification.allan import AllanDeviation, allan, allan_of_axes
from imuwb.identification.allan_fit import AllanFit, Coefficient, CorrelationTime, Region, fit_allan
from imuwb.identification.allan_statistics import equivalent_degrees_of_freedom
from imuwb.identification.averaging import averaging_factors
from imuwb.identification.lines import Line, find_lines
from imuwb.identification.stillness import Disturbance, Stillness, stillness

__all__ = [
    "AllanDeviation",
    "AllanFit",
    "Coefficient",
    "CorrelationTime",
    "Disturbance",
    "Line",
    "Region",
    "Stillness",
    "allan",
    "allan_of_axes",
    "averaging_factors",
    "equivalent_degrees_of_freedom",
    "find_lines",
    "fit_allan",
    "stillness",
]

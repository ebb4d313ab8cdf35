"""Options of noise over temperature."""

from dataclasses import dataclass
from typing import Annotated, Literal

from imuwb.options import Between, Form, Level, Options

CELSIUS = Between(-273.15, 1000.0, open_least=True)  #: °C


@dataclass(frozen=True)
class Parameters(Options):
    """Options of ``imuwb temperature``."""

    celsius: Annotated[
        tuple[float, ...], "Temperature of each log, in place of the logs' thermometers, in the order of the logs (°C).", CELSIUS,
        Form("T1,T2,...", "-30,0,30"),
    ] = ()  # fmt: skip
    cut: Annotated[
        Literal["auto", "set-point", "plateaus", "bins"],
        "Division of each log: one set-point, plateaus, or bins of a ramp; auto decides by the log's temperature.",
    ] = "auto"
    bins: Annotated[
        float, "Width of a ramp's bins; 0: 5, or 10 or 20 if smaller bins have too few samples (°C).", Between(0.0, 50.0)
    ] = 0.0  # fmt: skip
    lag: Annotated[
        float | None,
        "Time by which the thermometer lags the sensor, negative if the sensor lags; 0: none is removed; default: estimated (s).",
        Between(-3600.0, 3600.0),
    ] = None
    function: Annotated[
        Literal["auto", "constant", "linear", "quadratic", "cubic", "piecewise", "spline", "arrhenius"],
        "Function of temperature; auto chooses by cross-validation.",
    ] = "auto"
    reference: Annotated[
        float, "Temperature of the error model where none is known, and of bias changes (°C).", CELSIUS
    ] = 25.0
    size: Annotated[
        float, "Probability of a false alarm of each test of dependence on temperature.", Between(0.0, 0.5, open_least=True)
    ] = 0.05  # fmt: skip
    level: Level = 0.95
    as_measured: Annotated[
        bool,
        "First add what the autopilot took off before it logged the samples, by the parameters in a log of ArduPilot or PX4.",
    ] = False

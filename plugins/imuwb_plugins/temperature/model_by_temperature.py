"""From the result to an error model by temperature."""

from imuwb import __version__
from imuwb.identification.temperature import axis_model
from imuwb.stochastic import ImuErrorModel
from imuwb_plugins.temperature.result import Result


def error_model(result: Result) -> ImuErrorModel:
    """Return the error model: processes and biases of all axes as functions of temperature."""
    axes = {
        name: axis_model(axis.over, result.reference, gravity=name.startswith("accel"))
        for name, axis in result.axes.items()
    }
    rates = ", ".join(f"{sensor} {rate:.6g} Hz" for sensor, rate in result.rate_hz.items())
    provenance = {
        "log": result.source,
        "analysis": f"imuwb {__version__} temperature, by likelihood, {100 * result.level:g} % intervals at {result.reference:g} °C",
        "rate": rates,
        "bias": (
            f"accelerometers: change from {result.reference:g} °C; gyros: the mean of a still record, which includes the earth's "
            "rate"
        ),
    }
    return ImuErrorModel(result.imu, axes, provenance)

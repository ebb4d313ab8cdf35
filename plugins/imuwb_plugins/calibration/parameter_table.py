"""The table of calibrated parameters, their display units, and the figure of corrected samples."""

import math
from collections.abc import Iterable

import numpy as np

from imuwb.analysis import Curve, Figure, Table
from imuwb.arrays import Floats
from imuwb.colors import BLUE, INK, RED
from imuwb.statistics import Estimate
from imuwb.texts import estimate_text
from imuwb.units import STANDARD_GRAVITY
from imuwb_plugins.calibration.result import Terms, Trace

DEGREE = math.pi / 180
#: unit of a parameter -> factor and name of its display unit
DISPLAY = {
    "rad/s": (DEGREE, "deg/s"), "m/s²": (STANDARD_GRAVITY * 1e-3, "mg"), "1": (1e-2, "%"), "rad": (1e-3, "mrad"),
    "rad/s/(m/s²)": (DEGREE / STANDARD_GRAVITY, "deg/s/g"),
}  # fmt: skip
#: the same for the end of a unit of a log in counts or volts
PER = {"/(rad/s)": (1 / DEGREE, "/(deg/s)"), "/(m/s²)": (1 / STANDARD_GRAVITY, "/g")}
SENSORS = {"accel": ("Accelerometers", "m/s²"), "gyro": ("Gyros", "rad/s")}
#: parameter -> heading; the first that an axis has stand first
NAMES = {
    "bias": "bias b", "scale_factor": "scale factor s", "sensitivity": "sensitivity", "value_of_one": "value of one unit",
    "scale_factor_nonlinear": "non-linear s2", "cross_coupling_x": "coupling of x", "cross_coupling_y": "coupling of y",
    "cross_coupling_z": "coupling of z", "g_sensitivity_x": "g-sensitivity to x", "g_sensitivity_y": "g-sensitivity to y",
    "g_sensitivity_z": "g-sensitivity to z",
}  # fmt: skip


def display(unit: str) -> tuple[float, str]:
    """Return the factor from the display unit to the stored unit, and the name of the display unit."""
    if unit in DISPLAY:
        return DISPLAY[unit]
    for end, (factor, name) in PER.items():
        if unit.endswith(end):
            return factor, unit.removesuffix(end) + name
    return 1.0, unit


def parameter_text(parameter: Estimate | None) -> str:
    """Return a parameter with its interval in its display unit; a dash for None."""
    if parameter is None:
        return "—"
    factor, unit = display(parameter.unit)
    return estimate_text(parameter, unit, factor)


def parameter_table(parameters: Terms, sensor: str, imu: str, level: float) -> Table:
    """Return the parameters of a sensor's axes, one column for each parameter."""
    axes = {axis: terms for axis, terms in parameters.items() if axis.startswith(sensor)}
    kinds = [kind for kind in NAMES if any(kind in terms for terms in axes.values())]
    rows = tuple((axis, *(parameter_text(terms.get(kind)) for kind in kinds)) for axis, terms in axes.items())
    caption = (
        f"Value [{100 * level:g} % interval]; measured = (1 + s + s2 |true|/range) true + couplings · other axes"
        + (" + g-sensitivity · specific force + b." if sensor == "gyro" else " + b.")
    )
    return Table(f"{SENSORS[sensor][0]} of {imu}", ("axis", *(NAMES[k] for k in kinds)), rows, caption)


def trace_figure(trace: Trace, raw_unit: str) -> Figure:
    """Return samples before (blue) and after (red) the correction, and the true value (Hassaballa, figures 4 and 5)."""
    gyro = trace.title.startswith("Gyro")
    factor, unit = (DEGREE, "deg/s") if gyro else (1.0, "m/s²")
    if raw_unit and not trace.scaled:
        factor, unit = 1.0, raw_unit
    curves = [
        Curve("corrected", trace.x, trace.corrected / factor, RED, style="curve"),
        Curve("reference", trace.x, trace.reference / factor, INK, style="fit"),
    ]
    only = bool(raw_unit) and trace.scaled  # counts do not fit an axis in SI
    title = f"{trace.title}: corrected" if only else f"{trace.title}: raw and corrected"
    if not only:
        curves.insert(0, Curve("raw", trace.x, trace.raw / factor, BLUE, style="curve"))
    if np.ptp(trace.reference) > 0:  # the corrected samples cover the reference of a staircase, and must stay visible
        curves.insert(0, curves.pop())
    quantity = "gyro" if unit == raw_unit else "angular rate" if gyro else "specific force"
    return Figure(title, "time [s]", f"{quantity} [{unit}]", tuple(curves), x_scale="linear", y_scale="linear",
                  y_limits=_limits(c.y for c in curves))  # fmt: skip


def _limits(parts: Iterable[Floats]) -> tuple[float, float]:
    values = np.concatenate(list(parts))
    low, high = float(values.min()), float(values.max())
    air = 0.08 * (high - low) or 1e-6
    return low - air, high + 2 * air

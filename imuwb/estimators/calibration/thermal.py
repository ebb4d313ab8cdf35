"""Biases by temperature as the parameters of ArduPilot (INS_TCAL) and PX4 (TC): polynomials of third order.

ArduPilot (libraries/AP_InertialSensor/AP_InertialSensor_tempcal.cpp): with d = T - 35 °C, p(d) = (c1 d + c2 d² + c3 d³) · 1e-6, it
subtracts p at the clamped temperature less p at the temperature of calibration, so that a constant belongs into the offset.
PX4 (src/modules/sensors/temperature_compensation): offset = X0 + X1 d + X2 d² + X3 d³ with d = clamped T - TREF.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from imuwb.arrays import Floats
from imuwb.errors import MissingDataError, UsageError
from imuwb.log import AXES
from imuwb.stochastic import ImuErrorModel
from imuwb.texts import printable

if TYPE_CHECKING:  # an export without temperatures must not wait for the estimators
    from imuwb.identification.temperature.bias_polynomial import BiasPolynomial

ORDER = 3  #: of the polynomials of both autopilots
REFERENCE = 35.0  #: °C, fixed in ArduPilot
LEAST_SPAN = 10.0  #: °C, that ArduPilot asks for
THERMAL_FORMS = ("ardupilot-tcal", "px4-tc")


@dataclass(frozen=True, eq=False, slots=True)
class Curve:
    """The bias of one axis as a polynomial about a reference."""

    axis: str
    polynomial: BiasPolynomial  #: of third order
    misfit: float  #: largest difference at the set-points, SI

    @property
    def coefficients(self) -> tuple[float, ...]:
        """Return the coefficients of d⁰ ... d³, SI per °C^k."""
        return tuple(factor.value for factor in self.polynomial.factors)

    def at(self, celsius: float) -> float:
        """Return the bias at a temperature of the set-points (°C)."""
        return float(self.polynomial.at(np.array([celsius]))[0][0])


def curves(model: ImuErrorModel, reference: float) -> tuple[tuple[Curve, ...], float, float]:
    """Return the curves of all axes, and the range of temperatures (°C).

    Raises:
        MissingDataError: no axis has a bias by temperature, or the range is too narrow.
    """
    from imuwb.identification.temperature.bias_polynomial import polynomial_through  # noqa: PLC0415 - as above

    found: list[Curve] = []
    ends: list[tuple[float, float]] = []
    for axis in AXES:
        points = model.axes[axis].thermal_bias if axis in model.axes else ()
        if len(points) < 2:  # noqa: PLR2004 - one point is no curve
            continue
        celsius, bias = (np.array(column) for column in zip(*points, strict=True))
        polynomial = polynomial_through(celsius, bias, reference)
        found.append(Curve(axis, polynomial, float(np.abs(polynomial.at(celsius)[0] - bias).max())))
        ends.append((float(celsius[0]), float(celsius[-1])))
    if not found:
        raise MissingDataError(
            f"model {model.name} has no bias by temperature; a warm-up or a chamber record analysed by temperature gives one"
        )
    low, high = max(e[0] for e in ends), min(e[1] for e in ends)
    if high - low < LEAST_SPAN:
        raise MissingDataError(
            f"model {model.name} has biases from {low:g} to {high:g} °C; the autopilots need {LEAST_SPAN:g} °C or more"
        )
    return tuple(found), low, high


def thermal_text(model: ImuErrorModel, name: str, instance: int | None = None) -> tuple[str, tuple[str, ...]]:
    """Return the parameters of an autopilot for one of its IMUs, and notes.

    Args:
        model: with biases by temperature.
        name: ``"ardupilot-tcal"`` or ``"px4-tc"``.
        instance: number of the IMU, from 0; by default that of the model's log, else 0.

    Raises:
        UsageError, MissingDataError: no such form, or no curve.
    """
    if name not in THERMAL_FORMS:
        raise UsageError(f"--to {name}: it must be one of {', '.join(THERMAL_FORMS)}")
    instance = instance_of(model, instance, 2 if name == "ardupilot-tcal" else 3)
    reference = REFERENCE if name == "ardupilot-tcal" else 25.0
    found, low, high = curves(model, reference)
    ardupilot = name == "ardupilot-tcal"
    rows = _ardupilot(found, low, high, instance) if ardupilot else _px4(model, found, low, high, instance)
    worst = [max((c.misfit for c in found if c.axis.startswith(sensor)), default=0.0) for sensor in ("gyro", "accel")]
    notes = (
        f"a polynomial of third order; it misses the model's set-points by up to {worst[0]:.2g} rad/s and {worst[1]:.2g} m/s²",
        f"holds from {low:g} to {high:g} °C; outside, the autopilot keeps the value at the end",
        "axes are those of the sensor, before the board's rotation; the record must not have been compensated while it was logged",
    )
    comments = [f"# {printable(text)}" for text in (f"model {model.name}", *notes)]
    return "\n".join([*comments, *rows]) + "\n", notes


def _ardupilot(found: tuple[Curve, ...], low: float, high: float, instance: int) -> list[str]:
    prefix, number = f"INS_TCAL{instance + 1}", "" if instance == 0 else str(instance + 1)
    rows = [f"{prefix}_ENABLE 1", f"{prefix}_TMIN {low:.9g}", f"{prefix}_TMAX {high:.9g}"]
    for curve in found:
        sensor, axis = curve.axis.split("_")
        short = {"gyro": "GYR", "accel": "ACC"}[sensor]
        rows += [f"{prefix}_{short}{k}_{axis.upper()} {1e6 * curve.coefficients[k]:.9g}" for k in range(1, ORDER + 1)]
    middle = min(max(REFERENCE, low), high)
    for sensor, short in (("accel", "ACC"), ("gyro", "GYR")):
        offsets = [curve for curve in found if curve.axis.startswith(sensor)]
        rows += [f"INS_{short}{number}OFFS_{curve.axis[-1].upper()} {curve.at(middle):.9g}" for curve in offsets]
        rows += [f"INS_{short}{instance + 1}_CALTEMP {middle:.9g}"] if offsets else []
    return rows


def instance_of(model: ImuErrorModel, stated: int | None, most: int) -> int:
    """Return the number of an autopilot's IMU: as the user states it, else that of the model's log, else 0.

    Raises:
        UsageError: the autopilot has no such IMU.
    """
    own = stated_in(model, "imu instance")
    instance = stated if stated is not None else int(own) if own.isdecimal() else 0
    if not 0 <= instance <= most:
        raise UsageError(f"--instance {instance}: it must be 0 to {most}")
    return instance


def stated_in(model: ImuErrorModel, key: str) -> str:
    """Return what a model's provenance states, of a merged model that of any of its parts that states it; empty without."""
    texts = (text for name, text in model.provenance.items() if name == key or name.startswith(f"{key} of "))
    return next(texts, "")


def device_row(model: ImuErrorModel, sensor: str, name: str) -> str:
    """Return the parameter of PX4 with the number of the device that a model was made from, or what is to be done."""
    number = stated_in(model, f"{sensor} device")
    return f"{name}\t{number}" if number.isdecimal() else f"# set {name} to the device id of this sensor"


def _px4(model: ImuErrorModel, found: tuple[Curve, ...], low: float, high: float, instance: int) -> list[str]:
    rows: list[str] = []
    for sensor, short in (("accel", "A"), ("gyro", "G")):
        own = [curve for curve in found if curve.axis.startswith(sensor)]
        if not own:
            continue
        rows += [
            f"TC_{short}_ENABLE\t1",
            f"TC_{short}{instance}_TREF\t25",
            f"TC_{short}{instance}_TMIN\t{low:.9g}",
            f"TC_{short}{instance}_TMAX\t{high:.9g}",
        ]
        for curve in own:
            place = "xyz".index(curve.axis[-1])
            rows += [f"TC_{short}{instance}_X{k}_{place}\t{curve.coefficients[k]:.9g}" for k in range(ORDER + 1)]
        rows.append(device_row(model, sensor, f"TC_{short}{instance}_ID"))
    return rows


def subtracted(
    name: str, values: dict[str, float], celsius: Floats, instance: int = 0, sensors: Sequence[str] = ("gyro", "accel")
) -> tuple[Floats, Floats]:
    """Return what an autopilot with these parameters subtracts at temperatures: (n, 3) rad/s and (n, 3) m/s².

    ``sensors`` names those that are wanted; the other is 0. These are the formulas of the autopilots, by which a file is proven and a log's own compensation can be added back.
    """
    gyro, accel = np.zeros((len(celsius), 3)), np.zeros((len(celsius), 3))
    for sensor, out in (("gyro", gyro), ("accel", accel)):
        for place, axis in enumerate("XYZ" if sensor in sensors else ""):
            if name == "px4-tc":
                prefix = f"TC_{sensor[0].upper()}{instance}"
                d = np.clip(celsius, values[f"{prefix}_TMIN"], values[f"{prefix}_TMAX"]) - values[f"{prefix}_TREF"]
                out[:, place] = sum(values.get(f"{prefix}_X{k}_{place}", 0.0) * d**k for k in range(ORDER + 1))
                continue
            prefix, short = f"INS_TCAL{instance + 1}", {"gyro": "GYR", "accel": "ACC"}[sensor]
            number = "" if instance == 0 else str(instance + 1)
            low, high = values[f"{prefix}_TMIN"], values[f"{prefix}_TMAX"]

            def polynomial(t: Floats, axis: str = axis, prefix: str = prefix, short: str = short) -> Floats:
                d = np.clip(t, low, high) - REFERENCE  # noqa: B023 - used at once
                return 1e-6 * sum(
                    (values.get(f"{prefix}_{short}{k}_{axis}", 0.0) * d**k for k in range(1, ORDER + 1)),
                    np.zeros_like(d),
                )

            at = np.array([values[f"INS_{short}{instance + 1}_CALTEMP"]])
            out[:, place] = polynomial(celsius) - polynomial(at) + values.get(f"INS_{short}{number}OFFS_{axis}", 0.0)
    return gyro, accel

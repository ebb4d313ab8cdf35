"""From calibrated parameters to an error model: a new one, or one that already has the noise."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from imuwb.errors import UsageError
from imuwb.estimators.calibration import sensor_identity
from imuwb.identification.calibration import AxisCalibration
from imuwb.log import Log, source_of
from imuwb.statistics import Estimate
from imuwb.stochastic import AxisModel, ImuErrorModel
from imuwb.stochastic.deterministic import RAW

LARGEST_GAIN = 2.0  #: largest plausible gain of a log in SI; the smallest is its inverse


def completed_model(
    name: str,
    axes: Mapping[str, AxisCalibration],
    base: ImuErrorModel | None,
    provenance: dict[str, str],
    full_range: Mapping[str, float | None],
    celsius: float | None,
) -> tuple[ImuErrorModel, list[str]]:
    """Return the error model with the calibrated terms, and notes.

    Args:
        name: name of the IMU, for a new model.
        axes: the calibrated axes.
        base: model to complete; None: a new one.
        provenance: where the calibrated terms come from.
        full_range: rad/s or m/s² by sensor, on which the non-linear part is defined.
        celsius: °C, temperature of the calibration; None: not known.

    Raises:
        UsageError: the base model has terms by temperature, and the temperature is not known.
    """
    notes: list[str] = []
    models = {} if base is None else dict(base.axes)
    for axis, calibration in axes.items():
        before = models.get(axis, AxisModel())
        after = replace(before, **_terms(calibration, full_range.get(axis[:-2])))
        if before.thermal_bias or before.thermal_scale_factor:
            after, note = _shifted(axis, before, after, celsius)
            notes.append(note)
        models[axis] = after
    origin = {} if base is None else dict(base.provenance)
    kept = ImuErrorModel(name, {}) if base is None else base
    return replace(kept, axes=models, provenance={**origin, **provenance}), notes


def _terms(c: AxisCalibration, full_range: float | None) -> dict[str, Any]:
    terms: dict[str, Any] = {}
    if c.bias is not None:
        terms["bias"] = c.bias.value
    if c.scale_factor is not None:
        terms["scale_factor"] = c.scale_factor.value
        # A non-linear part of the base model belongs to the old scale factor, so it does not stay.
        terms["scale_factor_nonlinear"] = 0.0 if c.scale_factor_nonlinear is None else c.scale_factor_nonlinear.value
        if c.scale_factor_nonlinear is not None and full_range is not None:
            terms["range"] = full_range
    if any(e is not None for e in c.cross_coupling) or c.scale_factor is not None:
        terms["cross_coupling"] = tuple(0.0 if e is None else e.value for e in c.cross_coupling)
    if c.g_sensitivity is not None:
        terms["g_sensitivity"] = tuple(e.value for e in c.g_sensitivity)
    return terms


def _shifted(axis: str, before: AxisModel, after: AxisModel, celsius: float | None) -> tuple[AxisModel, str]:
    """Return the model whose curves of temperature are shifted to the calibrated values, and a note."""
    if celsius is None:
        raise UsageError(
            f"--into: {axis} has a bias or scale factor by temperature, and these logs have no temperature; "
            "use logs with a temperature, or a model without curves of temperature"
        )

    def shifted(points: tuple[tuple[float, float], ...], value: float) -> tuple[tuple[float, float], ...]:
        at = float(np.interp(celsius, [t for t, _ in points], [v for _, v in points])) if points else 0.0
        return tuple((t, v + value - at) for t, v in points)

    changed = replace(
        after,
        thermal_bias=shifted(before.thermal_bias, after.bias),
        thermal_scale_factor=shifted(before.thermal_scale_factor, after.scale_factor),
    )
    return changed, f"{axis}: its curves of temperature are shifted to the calibrated values at {celsius:.1f} °C"


def parameters_of(axis: str, c: AxisCalibration, raw: str) -> dict[str, Estimate]:
    """Return the parameters of an axis by name, with units.

    Args:
        axis: such as gyro_x.
        c: its calibration.
        raw: unit of the samples, empty for SI; the sensitivity then stands in place of the scale factor.
    """
    si, others = ("rad/s" if axis.startswith("gyro") else "m/s²"), [k for k in "xyz" if k != axis[-1]]
    terms: dict[str, Estimate] = {}
    gain = 1.0 + c.scale_factor.value if raw and c.scale_factor is not None else 1.0
    if c.bias is not None:
        terms["bias"] = c.bias.scaled(1.0, raw or si)
    if c.scale_factor is not None and raw:
        sensitivity = c.scale_factor.shifted(1.0).scaled(1.0, f"{raw}/({si})")
        terms["sensitivity"] = sensitivity
        if sensitivity.lower > 0:
            low, high, sigma = 1 / sensitivity.upper, 1 / sensitivity.lower, (sensitivity.sigma or 0.0) / gain**2
            terms["value_of_one"] = replace(sensitivity, value=1 / gain, lower=low, upper=high, sigma=sigma, unit=f"{si} per {raw}")  # fmt: skip
    elif c.scale_factor is not None:
        terms["scale_factor"] = c.scale_factor.scaled(1.0, "1")
    if c.scale_factor_nonlinear is not None:
        terms["scale_factor_nonlinear"] = c.scale_factor_nonlinear.scaled(1 / gain, "1")
    for other, e in zip(others, c.cross_coupling, strict=True):
        if e is not None:
            terms[f"cross_coupling_{other}"] = e.scaled(1 / gain, "rad")
    for other, e in zip("xyz", c.g_sensitivity or (), strict=False):
        terms[f"g_sensitivity_{other}"] = e.scaled(1.0, f"{raw or 'rad/s'}/(m/s²)")
    return terms


def provenance_of(method: str, logs: Sequence[Log], raw: str) -> dict[str, str]:
    """Return where the terms of a calibration come from; ``raw`` is the unit of the samples, empty for SI."""
    return {
        "calibration": method + (f", {raw} to SI" if raw else ""),
        "calibration_logs": "; ".join(source_of(log) for log in logs),
        **({RAW: raw} if raw else {}),
    } | sensor_identity(logs[0])


def full_range_of(sensor: str, base: ImuErrorModel | None, usual: Sequence[float], least: float) -> float:
    """Return the full range of a sensor in a base model, or the smallest usual one that has ``least``; all in one unit."""
    stated = [axis.range for name, axis in base.axes.items() if name.startswith(sensor) and axis.range] if base else []
    return max(stated) if stated else next(r for r in usual if r >= least)


def check_gain(axes: Mapping[str, AxisCalibration], raw: str) -> None:
    """Raise UsageError if the gain of a log in SI shows that its unit is wrong."""
    for axis, c in axes.items():
        if not raw and c.scale_factor is not None and not 1 / LARGEST_GAIN < 1 + c.scale_factor.value < LARGEST_GAIN:
            raise UsageError(
                f"{axis} shows {1 + c.scale_factor.value:.4g} times its input, so the log is not in the stated unit; "
                "give --units, or --raw count for a log in counts or volts"
            )

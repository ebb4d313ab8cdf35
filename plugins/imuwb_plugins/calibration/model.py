"""From parameters to an error model, alone or into one that has the noise."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from imuwb.errors import UsageError
from imuwb.stochastic import AxisModel, ImuErrorModel
from imuwb_plugins.calibration.result import Parameter

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from imuwb.identification.calibration import AxisCalibration, Estimate

LARGEST_GAIN = 2.0  #: of a log in SI


def read_base(path: Path | None) -> ImuErrorModel | None:
    """Return the model that the result goes into.

    Raises:
        UsageError: it is none.
    """
    return None if path is None else ImuErrorModel.read(path)


def made(
    name: str,
    axes: Mapping[str, AxisCalibration],
    base: ImuErrorModel | None,
    provenance: dict[str, str],
    full_range: Mapping[str, float | None],
    celsius: float | None,
) -> tuple[ImuErrorModel, list[str]]:
    """Return the model with these terms, and notes."""
    notes: list[str] = []
    found = dict(base.axes) if base is not None else {}
    for axis, calibration in axes.items():
        before = found.get(axis, AxisModel())
        after = replace(before, **_terms(calibration, full_range.get(axis[:-2])))
        if before.thermal_bias or before.thermal_scale_factor:
            after, note = _shifted(axis, before, after, celsius)
            notes.append(note)
        found[axis] = after
    origin = {} if base is None else dict(base.provenance)
    return ImuErrorModel(name if base is None else base.name, found, {**origin, **provenance}), notes


def _terms(c: AxisCalibration, full_range: float | None) -> dict[str, Any]:
    terms: dict[str, Any] = {}
    if c.bias is not None:
        terms["bias"] = c.bias.value
    if c.scale_factor is not None:
        terms["scale_factor"] = c.scale_factor.value
        # A linear fit alone: what a model had of the bend went with another line.
        terms["scale_factor_nonlinear"] = 0.0 if c.scale_factor_nonlinear is None else c.scale_factor_nonlinear.value
        if c.scale_factor_nonlinear is not None and full_range is not None:
            terms["range"] = full_range
    if any(e is not None for e in c.cross_coupling) or c.scale_factor is not None:
        terms["cross_coupling"] = tuple(0.0 if e is None else e.value for e in c.cross_coupling)
    if c.g_sensitivity is not None:
        terms["g_sensitivity"] = tuple(e.value for e in c.g_sensitivity)
    return terms


def _shifted(axis: str, before: AxisModel, after: AxisModel, celsius: float | None) -> tuple[AxisModel, str]:
    """Move curves of temperature to what was found at one temperature."""
    if celsius is None:
        message = f"--into: {axis} has bias or scale factor by temperature, and these logs have no temperature to say which one was calibrated"
        raise UsageError(message)

    def moved(points: tuple[tuple[float, float], ...], value: float) -> tuple[tuple[float, float], ...]:
        at = float(np.interp(celsius, [t for t, _ in points], [v for _, v in points])) if points else 0.0
        return tuple((t, v + value - at) for t, v in points)

    changed = replace(
        after,
        thermal_bias=moved(before.thermal_bias, after.bias),
        thermal_scale_factor=moved(before.thermal_scale_factor, after.scale_factor),
    )
    return changed, f"{axis}: its curves of temperature are moved to what was found at {celsius:.1f} °C"


def parameters(axis: str, c: AxisCalibration, raw: str) -> dict[str, Parameter]:
    """Return the parameters of an axis by name, with units; of a raw log the sensitivity in place of the scale factor."""
    si, others = ("rad/s" if axis.startswith("gyro") else "m/s²"), [k for k in "xyz" if k != axis[-1]]
    found: dict[str, Parameter] = {}
    gain = 1.0 + c.scale_factor.value if raw and c.scale_factor is not None else 1.0
    if c.bias is not None:
        found["bias"] = parameter(c.bias, raw or si)
    if c.scale_factor is not None and raw:
        s = c.scale_factor
        found["sensitivity"] = Parameter(1 + s.value, s.sigma, 1 + s.lower, 1 + s.upper, f"{raw}/({si})")
        if s.lower > -1:
            low, high = 1 / (1 + s.upper), 1 / (1 + s.lower)
            found["value_of_one"] = Parameter(1 / gain, s.sigma / gain**2, low, high, f"{si} per {raw}")
    elif c.scale_factor is not None:
        found["scale_factor"] = parameter(c.scale_factor, "1")
    if c.scale_factor_nonlinear is not None:
        found["scale_factor_nonlinear"] = parameter(c.scale_factor_nonlinear, "1", 1 / gain)
    for other, e in zip(others, c.cross_coupling, strict=True):
        if e is not None:
            found[f"cross_coupling_{other}"] = parameter(e, "rad", 1 / gain)
    for other, e in zip("xyz", c.g_sensitivity or (), strict=False):
        found[f"g_sensitivity_{other}"] = parameter(e, f"{raw or 'rad/s'}/(m/s²)")
    return found


def parameter(e: Estimate, unit: str, factor: float = 1.0) -> Parameter:
    """Return an estimate times a factor, with its unit."""
    low, high = sorted((e.lower * factor, e.upper * factor))
    return Parameter(e.value * factor, e.sigma * abs(factor), low, high, unit)


def check_gain(axes: Mapping[str, AxisCalibration], raw: str) -> None:
    """Raise UsageError where a log that is said to be in SI is not."""
    for axis, c in axes.items():
        if not raw and c.scale_factor is not None and not 1 / LARGEST_GAIN < 1 + c.scale_factor.value < LARGEST_GAIN:
            message = (
                f"{axis} shows {1 + c.scale_factor.value:.4g} times its input: the log is not in the unit that is said; "
                "give --units, or --raw count for a log in counts or volts"
            )
            raise UsageError(message)

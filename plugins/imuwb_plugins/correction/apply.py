"""The conditioner around ``imuwb.conditioning.correct``."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from imuwb.analysis import Review, Table
from imuwb.conditioning import correct
from imuwb.errors import MissingDataError, UsageError
from imuwb.log import AXES, Log
from imuwb.stochastic import AxisModel, ImuErrorModel, is_ideal, is_thermal
from imuwb.units import STANDARD_GRAVITY, coefficient_units
from imuwb_plugins.correction.parameters import Parameters


@dataclass(frozen=True, eq=False, slots=True)
class Applied:
    """The terms that were removed."""

    model: str
    axes: Mapping[str, AxisModel]
    celsius: tuple[float, float] | None  #: lowest and highest temperature of the log, where the model depends on it


def condition(log: Log, parameters: Parameters) -> tuple[Log, Applied]:
    """Return the log without the deterministic terms of the model in a file.

    Raises:
        UsageError: no model there, one without such terms, or terms that cannot be removed.
        MissingDataError: the log has no IMU, or lacks the temperature or the force that the model needs.
    """
    path = parameters.model
    model = ImuErrorModel.read(path)
    if is_ideal(model):
        raise UsageError(
            f"correction: {path}: the model has no bias, scale factor, cross-coupling or g-sensitivity to remove; imuwb calibration estimates them"
        )
    step = ("correction", f"model={path}")
    if any((done.name, done.parameters) == step for done in log.conditioning):
        raise UsageError(f"correction: {path}: its terms are already removed; give it once")
    changed, note = correct(log, model, step)
    if changed is log:
        raise MissingDataError(f"correction: {path}: {note}")
    temperature = log.imu().temperature
    span = None
    if is_thermal(model) and temperature is not None:
        span = float(temperature.value.min()), float(temperature.value.max())
    return changed, Applied(model.name, model.axes, span)


def draw(applied: Applied, review: Review) -> None:
    """Show the terms of each axis."""
    rows = tuple((axis, *_row(axis, applied.axes[axis])) for axis in AXES if axis in applied.axes)
    headings = ("axis", "bias", "scale factor", "non-linear scale factor", "cross-coupling [mrad]", "g-sensitivity [deg/s/g]")  # fmt: skip
    caption = ""
    if applied.celsius is not None:
        low, high = applied.celsius
        caption = f"… depends on temperature; the log's temperature is {low:.1f} to {high:.1f} °C."
    review.table(Table(f"Terms of {applied.model} that were removed", headings, rows, caption))


def _row(axis: str, model: AxisModel) -> tuple[str, ...]:
    unit = coefficient_units(axis, "rate")[1]
    bias = "…" if model.thermal_bias else f"{unit.from_si(model.bias):.6g} {unit.name}"
    scale = "…" if model.thermal_scale_factor else f"{100 * model.scale_factor:.5g} %"
    bent = f"{100 * model.scale_factor_nonlinear:.4g} %" if model.scale_factor_nonlinear else "—"
    cross = ", ".join(f"{1e3 * c:.4g}" for c in model.cross_coupling)
    leak = ", ".join(f"{np.degrees(g) * STANDARD_GRAVITY:.4g}" for g in model.g_sensitivity)
    return bias, scale, bent, cross if any(model.cross_coupling) else "—", leak if any(model.g_sensitivity) else "—"

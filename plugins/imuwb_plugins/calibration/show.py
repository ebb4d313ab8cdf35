"""Tables and figures of still positions. Nothing is computed here but units."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from imuwb.analysis import Curve, Figure, Table
from imuwb.colors import AXIS_COLORS
from imuwb.texts import decimals
from imuwb_plugins.calibration.words import display, interval_text

if TYPE_CHECKING:
    from collections.abc import Iterable

    from imuwb.analysis import Review
    from imuwb_plugins.calibration.result import Parameter, PositionResult, Trace

#: Hassaballa's figure 5: raw in blue, corrected in red
RAW, CORRECTED, REFERENCE = (76, 120, 168), (228, 87, 86), (225, 225, 228)
APART = 0.12  #: by which the points of three axes stand beside each other
SENSORS = {"accel": ("Accelerometers", "m/s²"), "gyro": ("Gyros", "rad/s")}
NAMES = {
    "bias": "bias b", "scale_factor": "scale factor s", "sensitivity": "sensitivity", "value_of_one": "unit of one",
    "scale_factor_nonlinear": "non-linear s2", "cross_coupling_x": "coupling of x", "cross_coupling_y": "coupling of y",
    "cross_coupling_z": "coupling of z", "g_sensitivity_x": "g-sensitivity to x", "g_sensitivity_y": "g-sensitivity to y",
    "g_sensitivity_z": "g-sensitivity to z",
}  # fmt: skip


def positions(result: PositionResult, review: Review) -> None:
    """Show parameters and residuals, then samples raw and corrected, then the positions."""
    for note in result.notes:
        review.note(note)
    for sensor in SENSORS:
        axes = [axis for axis in result.parameters if axis.startswith(sensor)]
        if axes:
            review.figure(_residuals(result, sensor))
    for sensor in SENSORS:
        if any(axis.startswith(sensor) for axis in result.parameters):
            review.table(parameter_table(result.parameters, sensor, result.imu, result.level))
    if result.printed:
        review.table(_printed(result))
    review.tab("Raw and corrected")
    for trace in result.traces:
        review.figure(trace_figure(trace, result.unit))
    review.tab("Positions")
    review.table(_positions(result))


def parameter_table(parameters: dict[str, dict[str, Parameter]], sensor: str, imu: str, level: float) -> Table:
    """Return the parameters of a sensor's axes, a column a parameter."""
    axes = {axis: found for axis, found in parameters.items() if axis.startswith(sensor)}
    kinds = [kind for kind in NAMES if any(kind in found for found in axes.values())]
    rows = tuple((axis, *(interval_text(found.get(kind)) for kind in kinds)) for axis, found in axes.items())
    caption = (
        f"Value [{100 * level:g} % interval]; measured = (1 + s + s2 |true|/range) true + couplings · other axes"
        + (" + g-sensitivity · force + b." if sensor == "gyro" else " + b.")
    )
    return Table(f"{SENSORS[sensor][0]} of {imu}", ("axis", *(NAMES[k] for k in kinds)), rows, caption, wide=True)


def _residuals(result: PositionResult, sensor: str) -> Figure:
    name, si = SENSORS[sensor]
    factor, unit = display(result.unit or si)
    curves: list[Curve] = []
    number = np.arange(1, len(result.positions) + 1, dtype=np.float64)
    for i, axis in enumerate("xyz"):
        key = f"{sensor}_{axis}"
        left = np.array([p.residual[key] for p in result.positions]) / factor
        sigma = np.array([p.sigma[key] for p in result.positions]) / factor
        at = number + APART * (i - 1)
        curves.append(
            Curve(key.replace("_", " "), at, left, AXIS_COLORS[axis], left - sigma, left + sigma, style="points")
        )
    zero = Curve("", np.array([0.5, len(number) + 0.5]), np.zeros(2), REFERENCE, style="fit")
    return Figure(
        f"{name}: residuals by position, with one sigma of the means' noise", "position", f"mean less fitted [{unit}]",
        (*curves, zero), x_scale="linear", y_scale="linear", x_limits=(0.5, len(number) + 0.5),
    )  # fmt: skip


def trace_figure(trace: Trace, raw_unit: str) -> Figure:
    """Return samples raw and corrected beside what they should be (Hassaballa, figures 4 and 5)."""
    gyro = trace.title.startswith("Gyro")
    factor, unit = (np.pi / 180, "deg/s") if gyro else (1.0, "m/s²")
    curves = [
        Curve("corrected", trace.x, trace.corrected / factor, CORRECTED, style="curve"),
        Curve("reference", trace.x, trace.reference / factor, REFERENCE, style="fit"),
    ]
    title = f"{trace.title}: corrected" if raw_unit else f"{trace.title}: raw and corrected"
    if not raw_unit:  # counts have no place on an axis of SI
        curves.insert(0, Curve("raw", trace.x, trace.raw / factor, RAW, style="curve"))
    if np.ptp(trace.reference) > 0:  # steps: what is corrected lies on them, and is to be seen
        curves.insert(0, curves.pop())
    what = "angular rate" if gyro else "specific force"
    return Figure(title, "time [s]", f"{what} [{unit}]", tuple(curves), x_scale="linear", y_scale="linear",
                  y_limits=_limits(c.y for c in curves))  # fmt: skip


def _limits(parts: Iterable[np.ndarray]) -> tuple[float, float]:
    values = np.concatenate(list(parts))
    low, high = float(values.min()), float(values.max())
    air = 0.08 * (high - low) or 1e-6
    return low - air, high + 2 * air


def _printed(result: PositionResult) -> Table:
    factor, unit = (1.0, result.unit) if result.unit else (1.0, "m/s²")
    rows = tuple(
        (
            axis, f"{x.up / factor:.6g} {unit}", f"{x.down / factor:.6g} {unit}", interval_text(x.bias),
            "—" if result.unit else interval_text(x.scale_factor),
        )
        for axis, x in result.printed.items()
    )  # fmt: skip
    caption = "Of two means alone: b = (up + down)/2, s = (up - down - 2 g)/(2 g)."
    return Table(
        "As printed: Hassaballa, equations 3 to 6",
        ("axis", "up", "down", "bias, eq. 5", "scale factor, eq. 6"),
        rows,
        caption,
    )


def _positions(result: PositionResult) -> Table:
    sensors = [s for s in SENSORS if any(axis.startswith(s) for axis in result.parameters)]
    headings = ["", "position", "up", "length"]
    for sensor in sensors:
        unit = result.unit or display(SENSORS[sensor][1])[1]
        headings += [
            f"{sensor} x, y, z [{result.unit or ('m/s²' if sensor == 'accel' else unit)}]",
            f"{sensor} residual [{unit}]",
        ]
    rows = tuple(
        (
            str(i + 1),
            p.name,
            p.up or _aslant(p.force),
            f"{p.seconds:.0f} s",
            *(cell for s in sensors for cell in _cells(result, i, s)),
        )
        for i, p in enumerate(result.positions)
    )
    chance = "below 1e-6" if result.probability < 1e-6 else f"{result.probability:.2g}"  # noqa: PLR2004 - as good as none
    caption = f"Axes forward, right, down: a level IMU stands z down. Probability of residuals as large by noise alone: {chance}."
    return Table("Positions", tuple(headings), rows, caption, wide=True)


def _aslant(force: tuple[float, float, float]) -> str:
    size = float(np.linalg.norm(force))
    return ", ".join(f"{f / size:+.2f}" for f in force)


def _cells(result: PositionResult, at: int, sensor: str) -> tuple[str, str]:
    p = result.positions[at]
    keys = [f"{sensor}_{k}" for k in "xyz"]
    factor, _ = display(result.unit or SENSORS[sensor][1])
    shown = 1.0 if sensor == "accel" else factor
    digits = decimals(6 * max(p.sigma[k] for k in keys) / shown)
    residual_digits = decimals(6 * max(p.sigma[k] for k in keys) / factor)
    means = ", ".join(f"{p.mean[k] / shown:.{digits}f}" for k in keys)
    return means, ", ".join(f"{p.residual[k] / factor:+.{residual_digits}f}" for k in keys)

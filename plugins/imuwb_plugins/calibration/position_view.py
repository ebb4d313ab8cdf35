"""Tables and figures of still positions."""

import numpy as np

from imuwb.analysis import Curve, Figure, Review, Table
from imuwb.colors import AXIS_COLORS, BLUE, INK
from imuwb.texts import decimals, number_text, seconds_text
from imuwb_plugins.calibration.notes import probability_text
from imuwb_plugins.calibration.parameter_table import SENSORS, display, parameter_table, parameter_text, trace_figure
from imuwb_plugins.calibration.result import Motions, PositionResult

APART = 0.12  #: distance, in positions, by which the points of the three axes are shifted sideways


def draw(result: PositionResult, review: Review) -> None:
    """Show parameters and residuals, then samples before and after the correction, then the positions."""
    for note in result.notes:
        review.note(note)
    sensors = [s for s in SENSORS if f"{s}_x" in result.parameters]
    for sensor in sensors:
        review.figure(_residuals(result, sensor))
    if result.motions is not None:
        review.figure(_motions(result.motions))
    for sensor in sensors:
        review.table(parameter_table(result.parameters, sensor, result.imu, result.level))
    if result.printed:
        review.table(_printed(result))
    review.tab("Raw and corrected")
    for trace in result.traces:
        review.figure(trace_figure(trace, result.unit))
    review.tab("Positions")
    review.table(_positions(result, sensors))


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
    zero = Curve("", np.array([0.5, len(number) + 0.5]), np.zeros(2), INK, style="fit")
    return Figure(
        f"{name}: residuals by position, with one standard deviation of the means' noise", "position [1]", f"mean minus fit [{unit}]",
        (*curves, zero), x_scale="linear", y_scale="linear", x_limits=(0.5, len(number) + 0.5),
    )  # fmt: skip


def _motions(motions: Motions) -> Figure:
    """Return the angle that the gyros miss over each motion."""
    number = np.array(motions.before, dtype=np.float64)
    ends = np.array([0.5, number[-1] + 0.5])
    size = np.degrees(np.array(motions.apart))
    mean = np.full(2, float(np.sqrt((size**2).mean())))
    curves = (
        Curve("motion", number, size, BLUE, style="points"),
        Curve("root mean square", ends, mean, INK, style="fit"),
    )
    return Figure(
        "Gyros over a motion: angle between the integrated direction of up and the accelerometers'", "position in which the motion begins [1]",
        "angle [deg]", curves, x_scale="linear", y_scale="linear", x_limits=(0.5, float(ends[1])),
        y_limits=(0.0, 1.2 * float(size.max()) or 1.0),
    )  # fmt: skip


def _printed(result: PositionResult) -> Table:
    unit = result.unit or "m/s²"
    rows = tuple(
        (
            axis, f"{x.up:.6g} {unit}", f"{x.down:.6g} {unit}", parameter_text(x.bias),
            "—" if result.unit else parameter_text(x.scale_factor),
        )
        for axis, x in result.printed.items()
    )  # fmt: skip
    caption = "From two means only: b = (up + down)/2, s = (up - down - 2 g)/(2 g)."
    if result.misplacement:
        tilt = number_text(np.degrees(result.misplacement))
        caption += f" The intervals contain a tilt of the faces of {tilt}° rms, which the equations leave out."
    headings = ("axis", "mean up", "mean down", "bias, eq. 5", "scale factor, eq. 6")
    return Table("As printed: Hassaballa, equations 3 to 6", headings, rows, caption)


def _positions(result: PositionResult, sensors: list[str]) -> Table:
    headings = ["number", "position", "up", "duration"]
    for sensor in sensors:
        unit = result.unit or display(SENSORS[sensor][1])[1]
        headings += [
            f"{sensor} mean x, y, z [{result.unit or ('m/s²' if sensor == 'accel' else unit)}]",
            f"{sensor} residual x, y, z [{unit}]",
        ]
    rows = tuple(
        (
            str(i + 1),
            p.name,
            p.up or ", ".join(f"{f / result.gravity:+.2f}" for f in p.force),
            seconds_text(p.seconds),
            *(cell for s in sensors for cell in _cells(result, i, s)),
        )
        for i, p in enumerate(result.positions)
    )
    caption = (
        "Axes are forward, right and down: a level IMU has z down. Probability that noise alone makes residuals as large as "
        f"these: {probability_text(result.probability)}."
    )
    return Table("Positions", tuple(headings), rows, caption)


def _cells(result: PositionResult, at: int, sensor: str) -> tuple[str, str]:
    """Return the means and the residuals of a position, with the decimals that their noise is worth."""
    p = result.positions[at]
    keys = [f"{sensor}_{k}" for k in "xyz"]
    factor, _ = display(result.unit or SENSORS[sensor][1])
    shown = 1.0 if sensor == "accel" else factor
    digits = decimals(6 * max(p.sigma[k] for k in keys) / shown)
    residual_digits = decimals(6 * max(p.sigma[k] for k in keys) / factor)
    means = ", ".join(f"{p.mean[k] / shown:.{digits}f}" for k in keys)
    return means, ", ".join(f"{p.residual[k] / factor:+.{residual_digits}f}" for k in keys)

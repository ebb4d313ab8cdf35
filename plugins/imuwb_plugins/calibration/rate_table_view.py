"""Tables and figures of a rate table."""

from pathlib import Path

import numpy as np

from imuwb.analysis import Curve, Figure, Review, Table
from imuwb.colors import AXIS_COLORS, INK
from imuwb.texts import decimals, seconds_text
from imuwb_plugins.calibration.parameter_table import display, parameter_table, parameter_text, trace_figure
from imuwb_plugins.calibration.result import TableResult, TableRun

ASIDE = 0.015  #: share of the span of rates by which the points of different runs are shifted sideways


def draw(result: TableResult, review: Review) -> None:
    """Show parameters, the fit and its residuals, then samples before and after the correction, then the steps."""
    for note in result.notes:
        review.note(note)
    review.figure(_error(result))
    review.figure(_residuals(result))
    review.table(parameter_table(result.parameters, "gyro", result.imu, result.level))
    review.table(_offsets(result))
    review.tab("Raw and corrected")
    for trace in result.traces:
        review.figure(trace_figure(trace, result.unit))
    review.tab("Steps")
    for run in result.runs:
        review.table(_steps(run, result))


def _error(result: TableResult) -> Figure:
    """Return the error of the turned gyros by rate, steps and fit; of logs in counts or volts, the measured value."""
    factor, unit = display(result.unit or "rad/s")
    curves: list[Curve] = []
    for run in result.runs:
        color = AXIS_COLORS[run.axis[-1]]
        steps = sorted(run.steps, key=lambda s: s.rate)
        rate = np.degrees([s.rate for s in steps])
        error, fitted = (
            np.array(column) / factor for column in zip(*((s.error, s.fitted_error) for s in steps), strict=True)
        )
        curves.append(Curve(_label(run), rate, error, color, style="points"))
        curves.append(Curve("", rate, fitted, color, style="fit"))
    quantity = f"measured [{unit}]" if result.unit else f"measured minus true rate and offset [{unit}]"
    title = "Turned gyros: effect of the scale factors, steps and fit"
    return Figure(title, "rate of the table [deg/s]", quantity, tuple(curves), x_scale="linear", y_scale="linear")


def _label(run: TableRun) -> str:
    return f"{run.axis.replace('_', ' ')}, {Path(run.name).name}"


def _residuals(result: TableResult) -> Figure:
    factor, unit = display(result.unit or "rad/s")
    curves: list[Curve] = []
    most = max(abs(float(np.degrees(s.rate))) for run in result.runs for s in run.steps) * 1.1
    for i, run in enumerate(result.runs):
        rate = np.degrees([s.rate for s in run.steps]) + ASIDE * most * (i - (len(result.runs) - 1) / 2)
        left = np.array([s.residual[run.axis] for s in run.steps]) / factor
        sigma = np.array([s.sigma[run.axis] for s in run.steps]) / factor
        curves.append(
            Curve(_label(run), rate, left, AXIS_COLORS[run.axis[-1]], left - sigma, left + sigma, style="points")
        )
    zero = Curve("", np.array([-most, most]), np.zeros(2), INK, style="fit")
    return Figure(
        "Turned gyros: residuals of the steps, with one standard deviation of the means' noise", "rate of the table [deg/s]",
        f"mean minus fit [{unit}]", (*curves, zero), x_scale="linear", y_scale="linear",
    )  # fmt: skip


def _offsets(result: TableResult) -> Table:
    rows = tuple(
        (Path(run.name).name, run.axis, *(parameter_text(run.offset[f"gyro_{k}"]) for k in "xyz"))
        for run in result.runs
    )
    caption = "Value of each gyro at rest in the attitude of the run: bias and g-sensitivity to the specific force."
    return Table("Offsets by run", ("run", "turned", "gyro x", "gyro y", "gyro z"), rows, caption)


def _steps(run: TableRun, result: TableResult) -> Table:
    factor, unit = display(result.unit or "rad/s")
    digits = decimals(2 * min(min(s.sigma.values()) for s in run.steps) / factor)
    rows = tuple(
        (
            f"{np.degrees(s.rate):+.6g} deg/s" if s.rate else "0 deg/s", seconds_text(s.seconds),
            *(f"{s.mean[f'gyro_{k}'] / factor:.{digits}f}" for k in "xyz"),
            *(f"{s.residual[f'gyro_{k}'] / factor:+.{digits}f}" for k in "xyz"),
        )
        for s in run.steps
    )  # fmt: skip
    headings = (
        "rate", "duration", *(f"mean of gyro {k} [{unit}]" for k in "xyz"), *(f"residual of gyro {k} [{unit}]" for k in "xyz"),
    )  # fmt: skip
    return Table(f"Steps of {Path(run.name).name}, which turns {run.axis}", headings, rows)

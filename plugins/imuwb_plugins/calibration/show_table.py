"""Tables and figures of a rate table. Nothing is computed here but units."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from imuwb.analysis import Curve, Figure, Table
from imuwb.colors import AXIS_COLORS
from imuwb.texts import decimals
from imuwb_plugins.calibration.show import REFERENCE, parameter_table, trace_figure
from imuwb_plugins.calibration.words import display, interval_text

if TYPE_CHECKING:
    from imuwb.analysis import Review
    from imuwb_plugins.calibration.result import Run, TableResult


ASIDE = 0.015  #: of the span, by which runs stand beside each other


def draw(result: TableResult, review: Review) -> None:
    """Show parameters, the fit and its residuals, then samples raw and corrected, then the steps."""
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
    """Return what the turned gyros show beyond the table's rate and their offset, and the fitted line; of raw logs what they show."""
    factor, unit = display(result.unit or "rad/s")
    curves: list[Curve] = []
    for run in result.runs:
        color = AXIS_COLORS[run.axis[-1]]
        rate, mean = _ordered(run)
        fitted = mean - np.array([s.residual[run.axis] for s in sorted(run.steps, key=lambda s: s.rate)])
        reference = 0.0 if result.unit else rate + run.offset[run.axis].value
        label = f"{run.axis.replace('_', ' ')}, {Path(run.name).name}"
        curves.append(Curve(label, np.degrees(rate), (mean - reference) / factor, color, style="points"))
        curves.append(Curve("", np.degrees(rate), (fitted - reference) / factor, color, style="fit"))
    what = f"measured [{unit}]" if result.unit else f"measured less true and offset [{unit}]"
    title = "Turned gyros: what scale factors make of the rate, steps and fit"
    return Figure(title, "table's rate [deg/s]", what, tuple(curves), x_scale="linear", y_scale="linear")


def _ordered(run: Run) -> tuple[np.ndarray, np.ndarray]:
    steps = sorted(run.steps, key=lambda s: s.rate)
    return np.array([s.rate for s in steps]), np.array([s.mean[run.axis] for s in steps])


def _residuals(result: TableResult) -> Figure:
    factor, unit = display(result.unit or "rad/s")
    curves: list[Curve] = []
    most = max(abs(float(np.degrees(s.rate))) for run in result.runs for s in run.steps) * 1.1
    for i, run in enumerate(result.runs):
        rate = np.degrees([s.rate for s in run.steps]) + ASIDE * most * (i - (len(result.runs) - 1) / 2)
        left = np.array([s.residual[run.axis] for s in run.steps]) / factor
        sigma = np.array([s.sigma[run.axis] for s in run.steps]) / factor
        label = f"{run.axis.replace('_', ' ')}, {Path(run.name).name}"
        curves.append(Curve(label, rate, left, AXIS_COLORS[run.axis[-1]], left - sigma, left + sigma, style="points"))
    zero = Curve("", np.array([-most, most]), np.zeros(2), REFERENCE, style="fit")
    return Figure(
        "Turned gyros: residuals of the steps, with one sigma of the means' noise", "table's rate [deg/s]", f"mean less fitted [{unit}]",
        (*curves, zero), x_scale="linear", y_scale="linear",
    )  # fmt: skip


def _offsets(result: TableResult) -> Table:
    rows = tuple(
        (Path(run.name).name, run.axis, *(interval_text(run.offset[f"gyro_{k}"]) for k in "xyz")) for run in result.runs
    )
    caption = "What each gyro shows at rest in that attitude: bias, and g-sensitivity to the force there."
    return Table("Offsets by run", ("run", "turned", "gyro x", "gyro y", "gyro z"), rows, caption)


def _steps(run: Run, result: TableResult) -> Table:
    factor, unit = display(result.unit or "rad/s")
    digits = decimals(2 * min(min(s.sigma.values()) for s in run.steps) / factor)
    rows = tuple(
        (
            f"{np.degrees(s.rate):+.6g} deg/s" if s.rate else "0 deg/s", f"{s.seconds:.1f} s",
            *(f"{s.mean[f'gyro_{k}'] / factor:.{digits}f}" for k in "xyz"),
            *(f"{s.residual[f'gyro_{k}'] / factor:+.{digits}f}" for k in "xyz"),
        )
        for s in run.steps
    )  # fmt: skip
    headings = ("rate", "length", *(f"gyro {k} [{unit}]" for k in "xyz"), *(f"residual {k} [{unit}]" for k in "xyz"))
    return Table(f"Steps of {Path(run.name).name}, which turns {run.axis}", headings, rows)

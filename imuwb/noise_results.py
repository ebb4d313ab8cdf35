"""What several analyses of noise state and show alike: periodic lines, and the curves and slopes of a fitted sum."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

from imuwb.analysis import Curve, Table
from imuwb.arrays import Floats
from imuwb.errors import MissingDataError
from imuwb.log import Log
from imuwb.notes import Note
from imuwb.statistics import Estimate
from imuwb.stochastic import Autoregressive
from imuwb.texts import converted_text, number_text
from imuwb.units import coefficient_units

if TYPE_CHECKING:  # what only shows an error model must not wait for the estimators
    from imuwb.identification import Line, Region

Outcome = TypeVar("Outcome")

SENSORS = {"gyro": "Gyroscopes", "accel": "Accelerometers"}
HARMONIC = 0.01  #: relative error of a multiple of a line's frequency that counts as a harmonic
_NOMINAL = {-0.5: "-1/2", 0.0: "0", 0.5: "+1/2"}


@dataclass(frozen=True, slots=True)
class LineResult:
    """A periodic line in SI."""

    frequency: float  #: Hz
    amplitude: Estimate
    name: str = ""  #: "line at 0.56 Hz" or "3 × 0.56 Hz", for example


@dataclass(frozen=True, eq=False, slots=True)
class ModelCurves:
    """A fitted sum and its terms on a fine grid, for a figure."""

    x: Floats  #: s or Hz
    total: Floats
    terms: tuple[Floats, ...]


def by_sensor(results: Mapping[str, Outcome]) -> dict[str, dict[str, Outcome]]:
    """Return the results of axes by sensor, ``gyro`` and ``accel``; a sensor without results is left out."""
    groups = {sensor: {a: r for a, r in results.items() if a.startswith(sensor)} for sensor in SENSORS}
    return {sensor: axes for sensor, axes in groups.items() if axes}


def missing_notes(log: Log, reasons: Mapping[str, str | None], note: str, what: str) -> list[Note]:
    """Return a note for each axis without a result.

    Args:
        log: the log.
        reasons: axis -> why it has no result; None: it has one.
        note: id of the notes.
        what: the result, such as "a spectrum".

    Raises:
        MissingDataError: no axis has a result.
    """
    missing = [Note(note, f"{axis}: {why}") for axis, why in reasons.items() if why]
    if len(missing) == len(reasons):
        raise MissingDataError(
            f"{log.provenance.path}: {log.imu().name}: no axis has {what}: {next(iter(reasons.values()))}"
        )
    return missing


def line_name(frequency: float, stronger: Iterable[float]) -> str:
    """Return the name of a line, Hz: a multiple of a stronger line's frequency, or its own frequency."""
    for base in stronger:
        ratio = frequency / base
        if round(ratio) > 1 and abs(ratio - round(ratio)) < HARMONIC * ratio:
            return f"{round(ratio)} × {base:.4g} Hz"
    return f"{frequency:.4g} Hz"


def line_result(axis: str, line: Line, name: str = "") -> LineResult:
    """Return a line of an axis such as ``gyro_x``."""
    return LineResult(line.frequency, line.amplitude.scaled(1.0, coefficient_units(axis, "rate")[0].name), name)


def line_table(lines: Mapping[str, Sequence[LineResult]], caption: str) -> Table:
    """Return the lines of each axis."""
    rows = tuple(
        (
            axis, f"{line.frequency:.4g} Hz", line.name or "—",
            converted_text(line.amplitude, coefficient_units(axis, "rate")[1]),
        )
        for axis, own in lines.items()
        for line in own
    )  # fmt: skip
    return Table("Periodic lines", ("axis", "frequency", "name", "amplitude"), rows, caption)


def slope_table(title: str, regions: Mapping[str, Sequence[Region]], unit: str, caption: str) -> Table:
    """Return the regions of each axis, with the slope of a free line and the nominal slope; ``unit`` is s or Hz."""
    rows = tuple(
        (
            axis, r.letter, f"{number_text(r.start)} to {number_text(r.end)} {unit}",
            f"{r.slope.value:+.3f} [{r.slope.lower:+.3f}, {r.slope.upper:+.3f}]", _NOMINAL.get(r.nominal, f"{r.nominal:+.0f}"),
            f"{r.departure:+.3f}" + ("" if r.nominal in r.slope else " (differs)"),
        )
        for axis, own in regions.items()
        for r in own
    )  # fmt: skip
    headings = ("axis", "term", "dominates from", "free slope [1]", "nominal slope [1]", "difference [1]")
    return Table(title, headings, rows, caption)


def with_models(axes: Iterable[tuple[Curve, ModelCurves | None]], factor: float) -> tuple[Curve, ...]:
    """Return each axis's curve, its fitted sum and the terms; the first sum and its terms are labelled in the legend.

    Args:
        axes: the curve of each axis, in display units, and its model in SI, if it has one.
        factor: value of one display unit in SI.
    """
    curves: list[Curve] = []
    for own, model in axes:
        labelled = not any(curve.style == "faint" for curve in curves)
        curves.append(own)
        if model is None:
            continue
        curves.append(Curve("fitted sum" if labelled else "", model.x, model.total / factor, own.color, style="fit"))
        for i, term in enumerate(model.terms):
            label = "its terms" if labelled and i == 0 else ""
            curves.append(Curve(label, model.x, term / factor, own.color, style="faint"))
    return tuple(curves)


def autoregressive_table(axes: Mapping[str, Sequence[Autoregressive]], caption: str = "") -> Table:
    """Return autoregressive processes of denoised samples, a row for each axis and order, in SI (as Quinchia's table 2)."""
    rows = tuple(
        (
            axis, str(len(p.alpha)), *(f"{p.alpha[k]:.6f}" if k < len(p.alpha) else "" for k in range(3)),
            f"{p.beta0**2:.4g} ({coefficient_units(axis, 'rate')[0].name})²",
        )
        for axis, processes in axes.items()
        for p in processes
    )  # fmt: skip
    headings = ("axis", "order", "alpha 1 [1]", "alpha 2 [1]", "alpha 3 [1]", "beta0²")
    return Table("Autoregressive processes of denoised samples (Quinchia, table 2)", headings, rows, caption)

"""Tables and figures of several logs of one sensor."""

from collections.abc import Iterator, Sequence

import numpy as np

from imuwb.analysis import Curve, Figure, Review, Table
from imuwb.arrays import Floats
from imuwb.colors import AXIS_COLORS
from imuwb.names import distinct
from imuwb.notes import Note
from imuwb.texts import coefficient_text
from imuwb.units import coefficient_units
from imuwb_plugins.noise.repeatability import Compared, Repeatability

LEAST = 0.1  #: share of a value at which a bar ends that would reach 0; a logarithmic axis has no 0
NAME = 24  #: columns of the name of a log
NARROW = 3.0  #: ratio of the ends of all bars, up to which a linear axis shows more than a logarithmic one
ASIDE = 0.08  #: distance between the axes' bars at one log


def draw(repeatability: Repeatability, review: Review) -> None:
    """Show the coefficients log by log, and the turn-on bias."""
    logs, differ = len(repeatability.names), ", ".join(repeatability.differ)
    review.note(
        Note("differ", f"{logs} logs differ in {differ} (1 % over all comparisons)")
        if differ
        else Note("alike", f"{logs} logs: no coefficient differs by more than chance (1 % over all comparisons)")
    )
    review.table(_coefficients(repeatability))
    for figure in _figures(repeatability):
        review.figure(figure)
    review.table(_turn_on(repeatability))


def _coefficients(repeatability: Repeatability) -> Table:
    rows: list[tuple[str, ...]] = []
    for axis, row in repeatability.coefficients.items():
        for letter, c in row.items():
            unit = coefficient_units(axis, letter)[1]
            cells = (coefficient_text(log, unit) for log in c.logs)
            differs = f"{axis} {letter}" in repeatability.differ
            rows.append((axis, letter, *cells, coefficient_text(c.mean, unit), _probability(c, differs=differs)))
    caption = (
        "All logs: root mean square, weighted by duration; a log that does not show a term counts with its limit. The probability that "
        "chance makes the logs differ as much comes from a chi-square test of the squared coefficients against their mean."
    )
    headings = ("axis", "term", *distinct(repeatability.names, NAME), "all logs", "probability [1]")
    return Table("Repeatability", headings, tuple(rows), caption)


def _probability(c: Compared, *, differs: bool) -> str:
    return "—" if c.probability is None else f"{c.probability:.2g}" + (" DIFFER" if differs else "")


def _turn_on(repeatability: Repeatability) -> Table:
    rows: list[tuple[str, ...]] = []
    for axis, t in repeatability.turn_on.items():
        unit = coefficient_units(axis, "rate")[1]
        means = (f"{unit.from_si(m):.6g} {unit.name}" for m in t.means)
        rows.append((axis, *means, coefficient_text(t.sigma, unit)))
    caption = (
        "Mean of each log, and the part of the scatter of the means that noise within the logs does not explain: sigma of the turn-on "
        "bias, which goes into the error model; < is a limit. For the accelerometers, the IMU must not have been moved between the logs."
    )
    return Table(
        "Turn-on bias",
        ("axis", *distinct(repeatability.names, NAME), "sigma of the turn-on bias"),
        tuple(rows),
        caption,
    )


def _figures(repeatability: Repeatability) -> Iterator[Figure]:
    """Yield N and B of each axis from log to log, with their intervals; of a limit only the upper end of the bar shows.

    What differs from log to log comes first.
    """
    names = distinct(repeatability.names, NAME)
    for _, figure in sorted(_each(repeatability, names), key=lambda pair: not pair[0]):
        yield figure


def _each(repeatability: Repeatability, names: Sequence[str]) -> Iterator[tuple[bool, Figure]]:
    """Yield whether an axis differs, and the figure, for each sensor and coefficient."""
    for sensor, title in (("gyro", "Gyroscopes"), ("accel", "Accelerometers")):
        axes = [axis for axis in repeatability.coefficients if axis.startswith(sensor)]
        for letter, name in (("N", "random walk N"), ("B", "bias instability B")):
            curves = tuple(_curve(repeatability, axis, letter, i) for i, axis in enumerate(axes))
            if any(np.isfinite(curve.y).any() for curve in curves):
                unit = coefficient_units(axes[0], letter)[1].name
                logs = ", ".join(f"{i}: {log}" for i, log in enumerate(names, 1))
                differs = any(f"{axis} {letter}" in repeatability.differ for axis in axes)
                yield differs, Figure(
                    f"{title}: {name} from log to log", f"log [1]; {logs}", f"{name} [{unit}]", curves, x_scale="whole",
                    y_scale="linear" if _are_near(curves) else "log", x_limits=(0.5, len(names) + 0.5),
                )  # fmt: skip


def _are_near(curves: Sequence[Curve]) -> bool:
    """Return whether all bars lie within a small ratio, so that a logarithmic axis would show them as one line."""
    ends = np.concatenate([part for c in curves for part in (c.y, c.lower, c.upper) if part is not None])
    known = ends[np.isfinite(ends)]
    return bool(known.min() > 0 and known.max() < NARROW * known.min())


def _curve(repeatability: Repeatability, axis: str, letter: str, place: int) -> Curve:
    logs, unit = repeatability.coefficients[axis][letter].logs, coefficient_units(axis, letter)[1]

    def shown(values: Sequence[float | None]) -> Floats:
        return np.array([np.nan if v is None else unit.from_si(v) for v in values])

    x = np.arange(1.0, len(logs) + 1) + ASIDE * (place - 1)
    y = shown([c.value for c in logs])
    lower, upper = np.fmax(shown([c.lower for c in logs]), y * LEAST), shown([c.upper for c in logs])
    return Curve(axis.replace("_", " "), x, y, AXIS_COLORS[axis[-1]], lower, upper)

"""Increments over a step as rates: an attitude increment as an angular rate, a velocity increment as a specific force."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.readers.quantities import DIMENSIONS
from imuwb.readers.text.column_names import Column
from imuwb.units import SECOND, Unit

#: quantity of an increment -> quantity of its rate
RATES = {"attitude_increment": "gyro", "velocity_increment": "accel"}
GAP = 0.5  #: relative difference from the usual step from which a step is not that of the increment
NEAR = (
    0.02  #: largest relative difference of nearly all steps from the usual step, if the stamps are those of the samples
)
EVEN = 0.9  #: least share of such steps; coarse stamps, and those of arrival, have fewer


def rate_column(column: Column) -> Column:
    """Return the column of the rate of an increment; any other column as it is."""
    if column.quantity not in RATES or column.unit is None:
        return column
    quantity, measure = RATES[column.quantity], column.unit
    rate = Unit(f"{measure.name}/s".replace("m/s/s", "m/s²"), DIMENSIONS[quantity], measure.factor)
    return replace(column, quantity=quantity, unit=rate)


class Increments:
    """Divides the increments of a log by their steps, piece by piece.

    The step is that of a column ``step``, else the difference from the stamp before. An increment after a gap, or with a stamp far
    from the usual step, covers the usual step. If the steps scatter, as those of coarse stamps and of arrival do, all increments cover
    the average step.
    """

    def __init__(self) -> None:
        """Begin a log."""
        self._before: int | None = None
        self._usual, self._even = 0.0, False

    def as_rates(self, time: Integers, values: Mapping[Column, Floats]) -> dict[Column, Floats]:
        """Return the cells of each column, increments as rates.

        Args:
            time: (n,) ns.
            values: cells of each column, in its unit.
        """
        if not any(column.quantity in RATES for column in values):
            return dict(values)
        stated = next((c for c in values if c.quantity == "step" and c.unit is not None), None)
        if stated is not None and stated.unit is not None:
            steps = values[stated] * stated.unit.factor
            steps = np.where(steps > 0, steps, np.nan)
        else:
            steps = self._steps(time)
        with np.errstate(over="ignore"):  # a damaged number may be of any size
            return {rate_column(c): cells / steps if c.quantity in RATES else cells for c, cells in values.items()}

    def _steps(self, time: Integers) -> Floats:
        """Return the steps that the increments cover, s; nan if there is only one row."""
        steps = np.diff(time, prepend=time[:1] if self._before is None else self._before) / SECOND
        if time.size:
            self._before = int(time[-1])
        rising = steps[steps > 0]
        if not self._usual and rising.size:
            usual = float(np.median(rising))
            self._even = bool(np.mean(np.abs(rising / usual - 1) < NEAR) > EVEN)
            self._usual = usual if self._even else float(rising.sum()) / max(1, steps.size - 1)
        usual = self._usual or np.nan
        if not self._even:
            return np.full(steps.size, usual)
        return np.where(np.abs(steps / usual - 1) < GAP, steps, usual)

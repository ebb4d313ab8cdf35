"""Gyro z at four settings of rate and bandwidth: table 2, figures 6 to 9."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from imuwb.analysis import Curve, Figure
from imuwb.arrays import Floats
from imuwb.colors import BLUE, GREEN, ORANGE, RED
from imuwb.conditioning.lowpass import design_lowpass
from imuwb.errors import MissingDataError
from imuwb.identification import AllanDeviation, allan, fit_allan
from imuwb.statistics import Estimate
from imuwb.units import UNITS
from imuwb_plugins.reproduce.estimates import in_unit
from imuwb_plugins.reproduce.printed import Key

SETTINGS = ((200.0, 256.0), (200.0, 42.0), (50.0, 256.0), (50.0, 42.0))  #: Hz, rate and bandwidth
COLORS = (RED, BLUE, ORANGE, GREEN)
SHORTEST = 1.0  #: s; at shorter averaging times the low-pass bends the curve
OPEN = 256.0  #: Hz, the bandwidth without the sensor's digital low-pass


@dataclass(frozen=True, eq=False, slots=True)
class Setting:
    """One setting."""

    rate: float  #: Hz
    bandwidth: float  #: Hz
    curve: AllanDeviation
    walk: Estimate | str  #: deg/√s

    @property
    def name(self) -> str:
        """Its name in table 2."""
        return f"{self.rate:g} Hz, {self.bandwidth:g} Hz"


def settings(values: Floats, rate: float, *, filtered: bool) -> tuple[Setting, ...]:
    """Return the four settings of a record.

    Args:
        values: (n,) rad/s, of gyro z.
        rate: Hz, a multiple of 200.
        filtered: whether the record went through the sensor's widest low-pass already.

    Raises:
        MissingDataError: the rate is no multiple of 200 Hz.
    """
    fastest = max(rate for rate, _ in SETTINGS)
    if not math.isclose(rate / fastest, round(rate / fastest), rel_tol=1e-3) or round(rate / fastest) < 1:
        raise MissingDataError(
            f"the record has {rate:g} Hz; the settings of table 2 need {fastest:g} Hz or a multiple of it"
        )
    return tuple(_setting(values, rate, *setting, filtered=filtered) for setting in SETTINGS)


def _setting(values: Floats, rate: float, wanted: float, bandwidth: float, *, filtered: bool) -> Setting:
    if not (filtered and bandwidth == OPEN):
        values = design_lowpass(rate, bandwidth).apply(values[:, None])[:, 0]
    kept = values[:: round(rate / wanted)]
    curve = allan(np.ascontiguousarray(kept), 1 / wanted)
    walk = fit_allan(curve, shortest=SHORTEST).coefficients["N"]
    return Setting(wanted, bandwidth, curve, in_unit(walk, "deg/√s"))


def table(found: tuple[Setting, ...]) -> Mapping[Key, Estimate | str]:
    """Return table 2."""
    return {Key("2", "ARW", setting.name): setting.walk for setting in found}


def figures(found: tuple[Setting, ...]) -> dict[str, tuple[Figure, ...]]:
    """Return figures 6 to 9."""
    by_setting = {(s.rate, s.bandwidth): s for s in found}
    single = {"6": (200.0, 42.0), "7": (50.0, 42.0), "8": (50.0, 256.0)}
    drawn = {number: (_figure([by_setting[one]]),) for number, one in single.items()}
    return drawn | {"9": (_figure(list(found)),)}


def _figure(found: list[Setting]) -> Figure:
    scale = UNITS["deg/s"].from_si(1.0)
    curves = tuple(
        Curve(
            s.name, s.curve.averaging_time, scale * s.curve.deviation, COLORS[SETTINGS.index((s.rate, s.bandwidth))],
            scale * s.curve.lower, scale * s.curve.upper,
        )
        for s in found
    )  # fmt: skip
    title = f"Gyro z at {found[0].name} bandwidth" if len(found) == 1 else "Gyro z at four settings of rate, bandwidth"
    return Figure(f"{title}: Allan deviation", "averaging time [s]", "Allan deviation [deg/s], 95 % intervals", curves)

"""The answer of the Allan analysis: N, the lowest point of the curve, and where the slope of white noise holds."""

from collections.abc import Mapping

from imuwb.analysis import Answer, Step
from imuwb.noise_results import by_sensor
from imuwb.statistics import UNKNOWN, Coefficient
from imuwb.texts import coefficient_cell, duration_text, number_text, seconds_text
from imuwb.units import UNITS, coefficient_units
from imuwb_plugins.allan.result import AllanAxis, Result
from imuwb_plugins.allan.trust import meanings, trust

_LOWEST = {"gyro": UNITS["deg/h"], "accel": UNITS["µg"]}
NOISE = Step("imuwb noise {log}", "one number an axis, by the best estimator, and a model")


def answer(result: Result) -> Answer:
    """Return what the curve of each axis says."""
    rows: list[tuple[str, ...]] = []
    trusts = {axis: trust(result, axis) for axis in result.axes}
    for sensor, axes in by_sensor(result.axes).items():
        unit = coefficient_units(f"{sensor}_x", "N")[1]
        rows += [
            (axis.replace("_", " "), coefficient_cell(_coefficients(r).get("N", UNKNOWN), unit), _lowest(sensor, r), _white(r),
             trusts[axis].word)
            for axis, r in axes.items()
        ]  # fmt: skip
        rows.append(("", unit.name, _LOWEST[sensor].name, "", ""))
    return Answer(
        about_record(result), ("", "N", "lowest point", "slope -1/2 holds", "trust"), tuple(rows), tuple(meanings(trusts)),
        (NOISE,), f"{100 * result.level:g} % intervals",
    )  # fmt: skip


def about_record(result: Result) -> str:
    """Return how long the record is, whether it is still, and its rates."""
    rates = " and ".join(dict.fromkeys(f"{number_text(rate)} Hz" for rate in result.rate_hz.values()))
    still = "" if result.moving is None else ", not still" if result.moving else " still"
    return f"{duration_text(result.duration)}{still}, {rates}"


def _coefficients(r: AllanAxis) -> Mapping[str, Coefficient]:
    return r.estimates.by[r.estimates.headline] if r.estimates else r.coefficients


def _lowest(sensor: str, r: AllanAxis) -> str:
    if not r.allan_deviation.size:
        return "—"
    at = int(r.allan_deviation.argmin())
    return f"{number_text(_LOWEST[sensor].from_si(float(r.allan_deviation[at])))} at {seconds_text(float(r.averaging_time[at]))}"


def _white(r: AllanAxis) -> str:
    region = next((region for region in r.regions if region.letter == "N"), None)
    return "nowhere" if region is None else f"{number_text(region.start)} to {seconds_text(region.end)}"

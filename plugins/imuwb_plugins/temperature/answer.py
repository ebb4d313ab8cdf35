"""The answer of noise over temperature: what follows temperature, and by how much."""

from imuwb.analysis import Answer, Step
from imuwb.noise_results import by_sensor
from imuwb.statistics import UNKNOWN
from imuwb.texts import coefficient_cell, number_text
from imuwb.units import UNITS, coefficient_units
from imuwb_plugins.temperature.axis_result import NAMES
from imuwb_plugins.temperature.result import Result, TemperatureAxis

DRIVE = Step("imuwb outage DRIVE --error-model {model}", "a drive with this sensor at its temperature")
_BIAS = {"gyro": UNITS["deg/h"], "accel": UNITS["mg"]}
TESTED = ("N", "B", "K", "bias")


def answer(result: Result) -> Answer:
    """Return N and the bias of each axis at the coldest and at the hottest temperature, and what the tests say."""
    first = next(iter(result.axes.values()))
    cold, hot = first.by_temperature[0].temperature, first.by_temperature[-1].temperature
    rows: list[tuple[str, ...]] = []
    for sensor, axes in by_sensor(result.axes).items():
        unit, bias = coefficient_units(f"{sensor}_x", "N")[1], _BIAS[sensor]
        for axis, own in axes.items():
            ends = (own.by_temperature[0], own.by_temperature[-1])
            cells = (coefficient_cell(point.coefficients.get("N", UNKNOWN), unit) for point in ends)
            change = (ends[1].bias.value - ends[0].bias.value) / bias.factor
            rows.append((axis.replace("_", " "), *cells, f"{change:+.3g}", _follow(own)))
        rows.append(("", unit.name, unit.name, bias.name, ""))
    headings = (
        "",
        f"N at {number_text(cold)} °C",
        f"N at {number_text(hot)} °C",
        "bias changes by",
        "follows temperature",
    )
    sentences = [
        f"What depends on temperature, by tests of which {100 * result.size:g} of 100 err, is a function of it in the model."
    ]
    sentences += [f"{note[:1].upper()}{note[1:]}." for note in (*result.doubts.all, *result.notes)][:2]
    return Answer(
        f"{len(first.by_temperature)} temperatures from {number_text(cold)} to {number_text(hot)} °C", headings, tuple(rows),
        tuple(sentences), (DRIVE,), f"{100 * result.level:g} % intervals",
    )  # fmt: skip


def _follow(own: TemperatureAxis) -> str:
    """Return what depends on temperature, by its test."""
    tests = own.dependence.by_coefficient
    names = [NAMES[name] for name in TESTED if (test := tests.get(name)) is not None and test.depends]
    return ", ".join(names) or "nothing"

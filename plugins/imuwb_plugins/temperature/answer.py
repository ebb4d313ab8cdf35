"""The answer of noise over temperature: what follows temperature, and by how much."""

from imuwb.analysis import Answer, Step
from imuwb.identification.temperature import CONTRADICTED
from imuwb.noise_results import by_sensor
from imuwb.statistics import UNKNOWN
from imuwb.statistics.distributions import normal_limit
from imuwb.texts import coefficient_cell, counted, decimals, number_text
from imuwb.units import UNITS, coefficient_units
from imuwb_plugins.temperature.axis_result import NAMES, kept_constant
from imuwb_plugins.temperature.result import Result, TemperatureAxis, lag_sentence

DRIVE = Step("imuwb outage DRIVE --error-model {model}", "a drive with this sensor at its temperature")
_BIAS = {"gyro": UNITS["deg/h"], "accel": UNITS["mg"]}
COLUMNS = ("bias change", "depends")  #: last headings
STAR = "*"  #: marks what is constant in the model although its test finds a dependence
TESTED = ("N", "B", "K", "bias")


def answer(result: Result) -> Answer:
    """Return N and the bias of each axis at the coldest and at the hottest temperature, and what the tests say."""
    first = next(iter(result.axes.values()))
    cold, hot = first.by_temperature[0].temperature, first.by_temperature[-1].temperature
    rows = [row for sensor in by_sensor(result.axes) for row in (*rows_of(result, sensor), units_of(sensor))]
    headings = ("", f"N at {number_text(cold)} °C", f"N at {number_text(hot)} °C", *COLUMNS)
    tested = _tested(result)
    sentences = [f"{note[:1].upper()}{note[1:]}." for note in _important(result)][:2]
    sentences.insert(1 if any(one.removed for one in result.lags) else 0, tested)
    return Answer(
        f"{counted(len(first.by_temperature), 'temperature')} from {number_text(cold)} to {number_text(hot)} °C", headings, tuple(rows),
        tuple(sentences), (DRIVE,), f"{100 * result.level:g} % intervals",
    )  # fmt: skip


def rows_of(result: Result, sensor: str) -> list[tuple[str, ...]]:
    """Return a row for each axis of a sensor: its name, N at both ends, the change of the bias, and what depends on temperature."""
    unit, bias = coefficient_units(f"{sensor}_x", "N")[1], _BIAS[sensor]
    rows: list[tuple[str, ...]] = []
    for axis, own in by_sensor(result.axes).get(sensor, {}).items():
        ends = (own.by_temperature[0], own.by_temperature[-1])
        cells = (coefficient_cell(point.coefficients.get("N", UNKNOWN), unit) for point in ends)
        rows.append((axis.replace("_", " "), *cells, _change(own, result.level, bias.factor), _follow(own)))
    return rows


def units_of(sensor: str) -> tuple[str, ...]:
    """Return the row of the units of a sensor's rows."""
    unit = coefficient_units(f"{sensor}_x", "N")[1].name
    return ("", unit, unit, _BIAS[sensor].name, "")


def _tested(result: Result) -> str:
    """Return how often the tests err, and what they mean for the error model."""
    wrong = f"{100 * result.size:g} % err"
    if not any(STAR in _follow(own) for own in result.axes.values()):
        return f"What depends on temperature (tests of which {wrong}) is a function of it in the model."
    tests = [own.dependence.by_coefficient.get(name) for own in result.axes.values() for name in TESTED]
    count = sum(test is not None and test.depends is not None for test in tests)
    return (
        f"Of these {count} tests {wrong}. What depends is a function of temperature in the model; {STAR} constant: a function needs "
        f"p < {CONTRADICTED:g} or must predict better."
    )


def _important(result: Result) -> list[str]:
    """Return what is said beside the figures: first lags that were removed, then doubts."""
    removed = [lag_sentence(one) for one in result.lags if one.removed]
    said = [note for note in result.notes if getattr(note, "id", "") != "lag"]
    return list(dict.fromkeys((*removed[:1], *result.doubts.all, *said)))


def _change(own: TemperatureAxis, level: float, unit: float) -> str:
    """Return the bias at the hottest temperature minus that at the coldest, with the decimals that its error carries."""
    change = own.by_temperature[-1].bias.value - own.by_temperature[0].bias.value
    sigma = float(own.over.biases.differences[0, -1]) ** 0.5
    return f"{change / unit:+.{decimals(2 * normal_limit(level) * sigma / unit)}f}"


def _follow(own: TemperatureAxis) -> str:
    """Return what depends on temperature, by its test; a star marks what the error model keeps constant nevertheless."""
    tests = own.dependence.by_coefficient
    names = [
        f"{NAMES[name]}{STAR if kept_constant(own, name) else ''}"
        for name in TESTED
        if (test := tests.get(name)) is not None and test.depends
    ]
    return ", ".join(names) or "nothing"

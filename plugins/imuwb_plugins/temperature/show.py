"""The recording of noise over temperature, and of a study of settings."""

from imuwb.analysis import Review
from imuwb.noise_results import SENSORS, by_sensor
from imuwb_plugins.temperature import figures, tables
from imuwb_plugins.temperature.result import Result, Study

STUDIED = ("gyro_y", "accel_y")  #: the paper's axes; figures of all axes would crowd the tab


def draw(result: Result, review: Review) -> None:
    """Show the result, the most important first."""
    for note in result.notes:
        review.note(note)
    groups = {sensor: list(axes) for sensor, axes in by_sensor(result.axes).items()}
    for sensor, axes in groups.items():
        review.figure(figures.by_temperature(result, SENSORS[sensor], axes, "N", "random walk N"))
    review.table(tables.dependence(result))
    for sensor, axes in groups.items():
        review.table(tables.random_walk(result, SENSORS[sensor], axes))
    for sensor, axes in groups.items():
        review.tab(f"Allan {sensor}")
        for axis in axes:
            review.figure(figures.allan(result, axis))
        review.table(tables.slopes(result, SENSORS[sensor], axes))
    _slow(result, groups, review)
    review.tab("AR(1)")
    for sensor, axes in groups.items():
        review.figure(figures.first_order(result, SENSORS[sensor], axes))
    for sensor, axes in groups.items():
        review.table(tables.first_order(result, SENSORS[sensor], axes))
    _bias(result, groups, review)
    review.tab("Functions")
    review.table(tables.functions(result))
    review.table(tables.candidates(result))


def _slow(result: Result, groups: dict[str, list[str]], review: Review) -> None:
    review.tab("B and K")
    for letter, name in (("B", "bias instability B"), ("K", "rate random walk K")):
        for sensor, axes in groups.items():
            review.figure(figures.by_temperature(result, SENSORS[sensor], axes, letter, name))
    for sensor, axes in groups.items():
        review.table(tables.slow(result, SENSORS[sensor], axes))


def _bias(result: Result, groups: dict[str, list[str]], review: Review) -> None:
    review.tab("Bias")
    for sensor, axes in groups.items():
        review.figure(figures.bias(result, SENSORS[sensor], axes))
    loops = {sensor: [a for a in axes if result.axes[a].hysteresis] for sensor, axes in groups.items()}
    for sensor, axes in loops.items():
        if axes:
            review.figure(figures.hysteresis(result, SENSORS[sensor], axes))
    if result.lags:
        review.table(tables.lags(result))
    for sensor, axes in groups.items():
        review.table(tables.bias(result, SENSORS[sensor], axes))
        if any(result.axes[axis].polynomial is not None for axis in axes):
            review.table(tables.polynomials(result, SENSORS[sensor], axes))


def draw_study(result: Study, review: Review) -> None:
    """Show AR(1) by temperature and setting."""
    axes = list(dict.fromkeys(axis for case in result.cases for axis in case.axes))
    for axis in [a for a in STUDIED if a in axes] or axes[:2]:
        review.figure(figures.study(result, axis))
    for axis in axes:
        review.table(tables.study(result, axis))

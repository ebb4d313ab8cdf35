"""Noise and bias by temperature of each IMU of the logs, in one run."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from imuwb.analysis import Answer, Review, Table
from imuwb.errors import MissingDataError
from imuwb.log import Log
from imuwb.noise_results import SENSORS, by_sensor
from imuwb.notes import Note
from imuwb.texts import estimate_text, name_of
from imuwb_plugins.temperature import figures, tables
from imuwb_plugins.temperature.answer import COLUMNS, rows_of, units_of
from imuwb_plugins.temperature.compute import run
from imuwb_plugins.temperature.parameters import Parameters
from imuwb_plugins.temperature.result import Result


@dataclass(frozen=True, eq=False, slots=True)
class ImuResults:
    """The IMUs of the logs, each over temperature."""

    imus: dict[str, Result]
    left_out: dict[str, str]  #: why an IMU has no result

    def __repr__(self) -> str:
        """Return the verdicts on each IMU."""
        return "\n".join(map(str, self.imus.values()))


def compare_imus(logs: Sequence[Log], parameters: Parameters) -> ImuResults:
    """Return each IMU over temperature; an IMU without a result has its reason.

    Args:
        logs: with one IMU each.
        parameters: of the analysis; temperatures that are given are those of the logs of each IMU.

    Raises:
        MissingDataError: no IMU has a result.
    """
    by_name: dict[str, list[Log]] = {}
    for log in logs:
        by_name.setdefault(log.imu().name, []).append(log)
    imus: dict[str, Result] = {}
    left_out: dict[str, str] = {}
    for name, own in by_name.items():
        try:
            imus[name] = run(own, parameters)
        except MissingDataError as error:
            left_out[name] = str(error)
    if not imus:
        raise MissingDataError("; ".join(f"{name_of(name)}: {why}" for name, why in left_out.items()))
    return ImuResults(imus, left_out)


ENDS = ("IMU", "", "N, coldest", "N, hottest", *COLUMNS)  #: headings


def answer_imus(result: ImuResults) -> Answer:
    """Return N and the change of the bias of the gyros of each IMU (or of its accelerometers), and what lags."""
    first = next(iter(result.imus.values()))
    sensor = next((s for s in ("gyro", "accel") if any(rows_of(own, s) for own in result.imus.values())), "gyro")
    rows = [(name_of(name), *row) for name, own in result.imus.items() for row in rows_of(own, sensor)]
    rows.append(("", *units_of(sensor)))
    sentences = [
        f"{name_of(name)}: the thermometer's lag is {estimate_text(one.lag, 's')}; it is removed."
        for name, own in result.imus.items()
        for one in own.lags[:1]
        if one.removed
    ]
    sentences += [f"{name_of(name)} is left out: {why}." for name, why in result.left_out.items()]
    title, level = f"{len(result.imus)} IMUs over temperature", f"{100 * first.level:g} % intervals"
    return Answer(title, ENDS, tuple(rows), tuple(sentences[:2]), (), level)


def draw_imus(result: ImuResults, review: Review) -> None:
    """Show a table of all IMUs, and each IMU on a tab."""
    for name, why in result.left_out.items():
        review.note(Note("imu-left-out", f"{name_of(name)} is left out: {why}"))
    review.table(_comparison(result))
    for name, own in result.imus.items():
        review.tab(name_of(name).strip("/"))
        for note in own.notes:
            review.note(note)
        drawn = [tables.dependence(own)]
        for sensor, by_axis in by_sensor(own.axes).items():
            axes = list(by_axis)
            for figure in (
                figures.by_temperature(own, SENSORS[sensor], axes, "N", "random walk N"),
                figures.bias(own, SENSORS[sensor], axes),
            ):
                review.figure(replace(figure, title=f"{name_of(name)}, {figure.title}"))
            drawn += [tables.random_walk(own, SENSORS[sensor], axes), tables.bias(own, SENSORS[sensor], axes)]
        drawn += [tables.lags(own)] if own.lags else []
        for table in drawn:
            review.table(replace(table, title=f"{name_of(name)}, {table.title}"))


def _comparison(result: ImuResults) -> Table:
    rows: list[tuple[str, ...]] = []
    for sensor in SENSORS:
        own = [(name_of(name), *row) for name, one in result.imus.items() for row in rows_of(one, sensor)]
        rows += [*own, ("", *units_of(sensor))] if own else []
    caption = (
        "At the coldest and the hottest temperature of each IMU; change of the bias from the coldest to the hottest."
    )
    return Table("The IMUs over temperature", ENDS, tuple(rows), caption)

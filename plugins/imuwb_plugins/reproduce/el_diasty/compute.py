"""From the options to the paper beside ours."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from imuwb import read
from imuwb.analysis import Bars, Figure
from imuwb.arrays import Floats
from imuwb.conditioning import design_kaiser
from imuwb.identification import AllanDeviation, allan, fit_allan, fit_autoregressive
from imuwb.log import Log
from imuwb.progress import tracked
from imuwb.statistics import Estimate
from imuwb_plugins.reproduce.comparison import Found, Reproduction, compared, of_other_data
from imuwb_plugins.reproduce.el_diasty import figures
from imuwb_plugins.reproduce.el_diasty.records import AXES, CELSIUS, IMUS, UNIT, Record, own, simulated
from imuwb_plugins.reproduce.estimates import in_unit
from imuwb_plugins.reproduce.parameters import ElDiasty
from imuwb_plugins.reproduce.printed import NORMAL, Key, paper

CUTOFFS: dict[str, float | None] = {"2": None, "3": 8.0, "4": 16.0, "5": 24.0}  #: table -> Hz
WIDTH = 4.0  #: Hz, of the transition
SHORTEST = 128  #: samples; at shorter averaging times the curve of noise of order 1 is not that of a random walk
SHOWN = 30  #: °C, of figures 8, 9 and 13 to 15
NAME = "el-diasty"
MISSING = "no log of a second IMU is given"


@dataclass(frozen=True, eq=False, slots=True)
class Measured:
    """What is found of one record."""

    record: Record
    curve: AllanDeviation
    walk: Estimate | str
    coefficients: dict[str, Estimate]  #: table -> C


def run(logs: Sequence[Log], parameters: ElDiasty) -> Reproduction:
    """Return the paper beside the simulations of all seeds, or beside the user's own records.

    Raises:
        MissingDataError: a log of the user's own lacks an axis.
        ImuwbError: it cannot be read.
    """
    del logs
    given = [read(path) for path in parameters.chamber]
    seeds = range(parameters.seed, parameters.seed + parameters.seeds)
    runs = [_run(given, parameters, seed) for seed in tracked(seeds, len(seeds))]
    reproduction = compared(paper(NAME), runs, _data(parameters), simulated=not given)
    return of_other_data(reproduction, frozenset({"1", *CUTOFFS})) if given else reproduction


def _data(parameters: ElDiasty) -> str:
    if parameters.chamber:
        return ", ".join(path.name for path in parameters.chamber)
    seeds = f", {parameters.seeds} seeds" if parameters.seeds > 1 else ""
    return f"{parameters.hours:g} h of each of two simulated IMUs at four temperatures{seeds}"


def _run(given: Sequence[Log], parameters: ElDiasty, seed: int) -> Found:
    records = own(given) if given else simulated(paper(NAME), parameters.hours, seed)
    count = len(AXES) * len(CELSIUS) * (1 if given else len(IMUS))
    measured = [_measured(record) for record in tracked(records, count)]
    values: dict[Key, Estimate | str] = {}
    for one in measured:
        values[Key("1", f"{one.record.axis}, N", one.record.item)] = one.walk
        for table, coefficient in one.coefficients.items():
            values[Key(table, f"{one.record.axis}, C", one.record.item)] = coefficient
    if given:
        values = {value.key: MISSING for value in paper(NAME).values()} | values
    return Found(values, dict(_figures(measured)))


def _measured(record: Record) -> Measured:
    curve = allan(record.values, record.dt)
    walk = in_unit(fit_allan(curve, shortest=SHORTEST * record.dt).coefficients["N"], UNIT[record.axis])
    coefficients = {table: _coefficient(filtered(record, fc), record.dt) for table, fc in CUTOFFS.items()}
    coefficients["2"] = coefficients["2"].scaled(-1.0, "1")  # the other tables have the sign of x(n) + C x(n-1) = e
    return Measured(record, curve, walk, coefficients)


def filtered(record: Record, cutoff: float | None) -> Floats:
    """Return the samples after the Kaiser low-pass; those that the whole filter does not cover are left out."""
    if cutoff is None:
        return record.values
    from scipy.signal import fftconvolve  # noqa: PLC0415 - slow to import

    taps = design_kaiser(1 / record.dt, cutoff - WIDTH / 2, cutoff + WIDTH / 2).taps
    return fftconvolve(record.values - record.values.mean(), taps, "valid")


def _coefficient(values: Floats, dt: float) -> Estimate:
    """Return the coefficient of order 1 with Bartlett's interval, which is valid for any series."""
    order = fit_autoregressive(values, dt, 1).orders[0]
    alpha, sigma = float(order.alpha[0]), float(order.alpha_sigma[0])
    return Estimate(alpha, alpha - NORMAL * sigma, alpha + NORMAL * sigma, sigma, "1")


def _figures(measured: Sequence[Measured]) -> Iterator[tuple[str, tuple[Figure | Bars, ...]]]:
    by_imu = {imu: [m for m in measured if m.record.imu == imu] for imu in IMUS}
    number = 4
    for imu, its in by_imu.items():
        for axis in AXES:
            curves = {m.record.celsius: m.curve for m in its if m.record.axis == axis}
            yield str(number), (figures.allan_by_temperature(imu, axis, curves),) if curves else ()
            number += 1
    for place, (imu, its) in enumerate(by_imu.items()):
        by_axis = {axis: [m for m in its if m.record.axis == axis] for axis in AXES} if its else {}
        unfiltered = {
            a: ([m.record.celsius for m in ms], [m.coefficients["2"] for m in ms]) for a, ms in by_axis.items()
        }
        yield str(10 + place), (figures.by_temperature(imu, unfiltered),) if its else ()
        warm = {a: next(m for m in ms if m.record.celsius == SHOWN) for a, ms in by_axis.items()}
        cutoffs = {t: fc for t, fc in CUTOFFS.items() if fc}
        at = {a: (list(cutoffs.values()), [m.coefficients[t] for t in cutoffs]) for a, m in warm.items()}
        yield str(14 + place), (figures.by_cutoff(imu, at),) if its else ()
    shown = next(
        (m.record for m in by_imu[IMUS[-1]] or measured if m.record.axis == "gyro y" and m.record.celsius == SHOWN),
        None,
    )
    if shown is not None:
        after = Record(shown.imu, shown.axis, shown.celsius, filtered(shown, CUTOFFS["4"]), shown.dt)
        yield "8", (figures.spectrum(shown),)
        yield "9", figures.least_squares(shown)
        yield "12", figures.kaiser(1 / shown.dt, 14.0, 18.0)
        yield "13", (figures.spectrum(shown, after),)

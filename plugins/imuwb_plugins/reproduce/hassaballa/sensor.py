"""The sensor of the paper: its data sheet found again (table 1), and its deterministic errors (figures 1, 4 and 5)."""

import math
from collections.abc import Iterator

import numpy as np

from imuwb.analysis import Curve, Figure
from imuwb.arrays import Floats
from imuwb.colors import BLUE, ORANGE, RED
from imuwb.conditioning.correction import corrected_log
from imuwb.conditioning.lowpass import design_lowpass
from imuwb.identification import allan, fit_allan
from imuwb.log import Log
from imuwb.simulation import Tolerances, rate_table, six_position, specimen
from imuwb.statistics import Estimate
from imuwb.stochastic import Constant, ImuErrorModel, Sum
from imuwb.units import UNITS
from imuwb_plugins.calibration import METHODS
from imuwb_plugins.reproduce.estimates import by_parts, exact, in_unit
from imuwb_plugins.reproduce.printed import NORMAL, Key

FAST = 1000.0  #: Hz
BAND = 100.0  #: Hz, of the total noise
SPECIMENS = 2000
STEPS = (10.0, 30.0, 60.0, 90.0, 120.0)  #: deg/s
DENSITY = {"gyro z": ("rate noise density", "deg/s/√Hz"), "accel z": ("noise density", "µg/√Hz")}
SENSITIVITY = {"gyro z": ("deg/s", "LSB/(deg/s)"), "accel z": ("g", "LSB/g")}
ZERO = {"gyro z": "deg/s", "accel x": "mg", "accel y": "mg", "accel z": "mg"}
POINTS = 1000  #: of a curve over time


def data_sheet(model: ImuErrorModel, hours: float, seed: int) -> Iterator[tuple[Key, Estimate | str]]:
    """Yield table 1."""
    n = round(hours * 3600 * FAST)
    for stream, (name, (quantity, unit)) in zip(np.random.SeedSequence(seed).spawn(2), DENSITY.items(), strict=True):
        axis = model.axes[name.replace(" ", "_")]
        noise = Sum(tuple(t for t in axis.processes.terms if not isinstance(t, Constant))).sample(
            n, 1 / FAST, np.random.default_rng(stream)
        )
        yield Key("1", quantity, name), in_unit(fit_allan(allan(noise, 1 / FAST)).coefficients["N"], unit)
        step, sensitivity = SENSITIVITY[name]
        yield Key("1", "sensitivity", name), exact(1 / UNITS[step].from_si(axis.lsb or math.nan), sensitivity)
        if name.startswith("gyro"):
            yield Key("1", "total noise at 100 Hz", name), _total(noise)
    yield from _zeros(model, seed)


def _total(noise: Floats) -> Estimate:
    """Return the standard deviation after the low-pass, deg/s."""
    filtered = design_lowpass(FAST, BAND).apply(noise[:, None])[:, 0]
    ((value, low, high),) = by_parts(filtered, np.array([filtered.std()]), lambda part: np.array([part.std()]))
    return Estimate(*map(UNITS["deg/s"].from_si, (value, low, high)), unit="deg/s")


def _zeros(model: ImuErrorModel, seed: int) -> Iterator[tuple[Key, Estimate]]:
    """Yield the standard deviations of the turn-on biases of many specimens."""
    drawn = [specimen(model, seed * SPECIMENS + i, None) for i in range(SPECIMENS)]
    for name, unit in ZERO.items():
        biases = np.array([one.axes[name.replace(" ", "_")].bias for one in drawn])
        value = UNITS[unit].from_si(float(biases.std(ddof=1)))
        half = NORMAL * value / math.sqrt(2 * SPECIMENS)
        yield Key("1", "zero tolerance", name), Estimate(value, value - half, value + half, unit=unit)


def figures(model: ImuErrorModel, seed: int) -> Iterator[tuple[str, tuple[Figure, ...]]]:
    """Yield figures 1, 4 and 5: a rate table, and one of six positions before and after the calibration."""
    one = specimen(model, seed, Tolerances())
    turned = rate_table(one, seed, tuple(math.radians(r) for r in STEPS), axes="z", seconds=20.0)
    yield (
        "1",
        (
            _over_time(
                "Gyro z on a rate table", "deg/s", {"as measured": (next(iter(turned.logs.values())), BLUE)}, "gyro_z"
            ),
        ),
    )
    cube = six_position(one, seed, seconds=60.0)
    found = METHODS["six-position"].run(list(cube.logs.values()), METHODS["six-position"].Parameters())
    level = cube.logs["up_z"]
    corrected, _ = corrected_log(level, METHODS["six-position"].error_model(found))
    logs = {"before": (level, RED), "after": (corrected, ORANGE)}
    yield "4", (_over_time("Accelerometer z, before and after calibration", "m/s²", logs, "accel_z"),)
    yield "5", (_over_time("Gyro z, before and after correction", "deg/s", logs, "gyro_z"),)


def _over_time(title: str, unit: str, logs: dict[str, tuple[Log, tuple[int, int, int]]], axis: str) -> Figure:
    curves = list[Curve]()
    for name, (log, color) in logs.items():
        time, values = log.imu().axes()[axis]
        step = max(time.size // POINTS, 1)
        seconds = (time[::step] - time[0]) * 1e-9
        curves.append(Curve(name, seconds, UNITS[unit].from_si(1.0) * values[::step], color, style="curve"))
    return Figure(
        title, "time [s]", f"{axis.replace('_', ' ')} [{unit}]", tuple(curves), x_scale="linear", y_scale="linear"
    )

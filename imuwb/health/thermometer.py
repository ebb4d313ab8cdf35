"""Faults of an IMU's thermometer: another unit than °C, spikes, and readings that are stuck while the sensor warms or cools."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from imuwb.arrays import Booleans, Floats
from imuwb.health.channel import LOOKED_AT, Channel, channels
from imuwb.health.fault import Fault, Severity
from imuwb.log import ImuStream, Log, Scalars
from imuwb.sampling import runs
from imuwb.units import UNITS

COLDEST, HOTTEST = -60.0, 125.0  #: °C; no IMU works beyond
SPECIFIED = 85.0  #: °C; most IMUs are specified up to this temperature
OUTER = 0.01  #: share of the readings, at each end, that do not show the range
LEAP = 5.0  #: °C; no thermometer of an IMU changes by more from one reading to the next
LONGER = 20.0  #: times the usual change, or the usual time between changes: far more than usual
BRIEF = 10.0  #: s; readings between two leaps that last no longer are spikes
AROUND, SHORTER = (
    4,
    0.25,
)  #: stretches between leaps on either side; a spike lasts for at most this share of the longest of them
CONSTANT, HOUR = (
    600.0,
    3600.0,
)  #: s; a temperature that stays for longer is worth a note, and one that stays for hours is stuck
FINE = 0.05  #: °C; a thermometer with smaller steps does not stay at one reading for minutes
BLOCKS = 200  #: number of means of a log that show whether the biases follow the temperature
FEWEST = 8  #: means
FOLLOWS = 0.9  #: correlation of a bias with the readings, from which the bias shows the temperature
CHANGED = 3.0  #: °C; the bias shows that the temperature changed by more while the reading stayed
SCATTERS = 10.0  #: times the scatter of the bias about its line over temperature; such a change is no chance
WARMED = 2.0  #: °C; over a smaller range the readings do not show how a bias depends on temperature

#: unit -> factor and offset of its values in °C; the first unit that makes the readings plausible is the likely one
_UNITS: dict[str, tuple[float, float]] = {
    "K": (1.0, -273.15), "°F": (5 / 9, -160 / 9), "cdegC": (0.01, 0.0),
    "counts of an MPU-6050 (raw/340 + 36.53)": (1 / 340, 36.53),
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Stuck:
    """The longest span of one reading that is no temperature."""

    start: float  #: s from the log's start
    end: float
    value: float  #: °C
    whole: bool  #: there is no other reading
    #: °C; the change that the biases show during the span; 0: they show none
    change: float
    severity: Severity


def thermometer_name(imu: ImuStream) -> str:
    """Return the name under which the faults of an IMU's thermometer are listed."""
    return f"{imu.name} thermometer"


def sound_thermometer(log: Log) -> tuple[Scalars | None, tuple[Fault, ...]]:
    """Return the thermometer of the log's (first) IMU without its spikes, and its faults; None: it has no thermometer."""
    imu = log.imu()
    if imu.temperature is None or not len(imu.temperature):
        return None, ()
    kept = ~spikes(imu.temperature)
    readings = Scalars(imu.temperature.name, imu.temperature.time[kept], imu.temperature.value[kept])
    return readings, tuple(thermometer_faults(log, imu, channels(log, imu)))


def thermometer_faults(log: Log, imu: ImuStream, axes: Mapping[str, Channel]) -> Iterator[Fault]:
    """Yield what is wrong with the thermometer of an IMU.

    Args:
        log: the log.
        imu: the IMU.
        axes: those whose samples are not all equal; without them a stuck thermometer is found by its readings alone.
    """
    thermometer, name = imu.temperature, thermometer_name(imu)
    if thermometer is None or not len(thermometer):
        return
    time = log.seconds(thermometer.time)
    odd = spikes(thermometer)
    if odd.any():
        text = f"spikes of the temperature, to {_range(thermometer.value[odd])} °C"
        yield Fault(name, "temperature spikes", text, "fault", int(odd.sum()), float(time[np.argmax(odd)]),
                    consequence="these readings are no temperatures: leave them out")  # fmt: skip
    usual = thermometer.value[~odd] if odd.any() else thermometer.value
    if unit := unlikely_unit(usual):
        yield Fault(name, "temperature unit", f"the temperature is {_range(usual)} °C, which no IMU survives", "fault",
                    consequence=f"the unit is likely {unit}, not °C" + (f": --units temperature={unit}" if unit in UNITS else ""))  # fmt: skip
    elif np.quantile(_some(usual), 1 - OUTER) > SPECIFIED:
        yield Fault(name, "hot", f"the temperature is {_range(usual)} °C", "warning",
                    consequence="most IMUs are specified up to 85 °C; are these °F?")  # fmt: skip
    if odd.any():
        imu = replace(imu, temperature=Scalars(thermometer.name, thermometer.time[~odd], usual))
    stuck = stuck_thermometer(log, imu, axes)
    if stuck is not None:
        what = f"temperature stays at {stuck.value:g} °C for {(stuck.end - stuck.start) / 60:.0f} min"
        what += f", while the biases show a change by {stuck.change:.2g} °C" if stuck.change else ""
        consequence = "biases over temperature are wrong there: leave this span out with --start and --end"
        if stuck.severity == "note":
            consequence = "very steady, or stuck"
        if stuck.whole:
            consequence = "probably not measured; the log shows nothing about temperature"
        kind = "constant temperature" if stuck.whole else "stuck thermometer"
        place = (None, None) if stuck.whole else (stuck.start, stuck.end - stuck.start)
        yield Fault(name, kind, what, stuck.severity, 1, *place, consequence)


def spikes(thermometer: Scalars) -> Booleans:
    """Return which readings are spikes, (n,): for a few seconds at most they leap away from the readings around them."""
    celsius = thermometer.value
    leaps = np.abs(np.diff(celsius))
    if not leaps.size:
        return np.zeros(celsius.size, dtype=bool)
    far = leaps > max(LEAP, LONGER * float(np.median(_some(leaps))))
    if not far.any():
        return np.zeros(celsius.size, dtype=bool)
    part = np.concatenate([[0], np.cumsum(far)])
    edges = np.flatnonzero(np.concatenate([[True], far, [True]]))
    time = thermometer.time / 1e9
    length = time[edges[1:] - 1] - time[edges[:-1]]
    # The readings between two spikes may be brief too, but they last far longer than those.
    around = np.lib.stride_tricks.sliding_window_view(np.pad(length, AROUND), 2 * AROUND + 1).max(axis=1)
    brief = ((length <= BRIEF) & (length < SHORTER * around))[part]
    if brief.all():
        return np.zeros(celsius.size, dtype=bool)
    usual = np.interp(time, time[~brief], celsius[~brief])
    return brief & (np.abs(celsius - usual) > LEAP)


def unlikely_unit(celsius: Floats) -> str:
    """Return the likely unit of readings that no IMU survives in °C; empty: they are plausible."""
    low, high = (float(x) for x in np.quantile(_some(celsius), (OUTER, 1 - OUTER)))
    if low >= COLDEST and high <= HOTTEST:
        return ""
    fitting = (
        unit
        for unit, (factor, offset) in _UNITS.items()
        if low * factor + offset >= COLDEST and high * factor + offset <= HOTTEST
    )
    return next(fitting, "unknown")


def stuck_thermometer(log: Log, imu: ImuStream, axes: Mapping[str, Channel]) -> Stuck | None:
    """Return the longest span in which a thermometer does not change, if it is longer than a temperature stays.

    It is a fault if the biases of the axes, which follow the readings at other times, show that the temperature changes during
    the span, or if a thermometer of fine steps does not change for more than an hour. Readings that stay for ten minutes are
    remarkable only.
    """
    thermometer = imu.temperature
    if thermometer is None or not len(thermometer):
        return None
    time, celsius = log.seconds(thermometer.time), thermometer.value
    first, length = runs(np.diff(celsius) == 0)
    if not first.size:
        return None
    spans = time[first + length] - time[first]
    at = int(np.argmax(spans))
    start, end, value = float(time[first[at]]), float(time[first[at] + length[at]]), float(celsius[first[at]])
    if end - start <= CONSTANT:
        return None
    if np.ptp(celsius) == 0:
        invented = bool(log.truth)  # a simulator may keep a temperature
        severity: Severity = "fault" if end - start > HOUR and not invented else "note"
        return Stuck(start, end, value, whole=True, change=0.0, severity=severity)
    changes = celsius.size - 1 - int(length.sum())  # they count as spans of length 0
    usual = 0.0 if changes > spans.size else float(np.median(np.concatenate([spans, np.zeros(changes)])))
    if end - start <= LONGER * usual:
        return None
    change = _change(time, celsius, axes, (start, end))
    severity = "fault" if change or (_step(celsius) < FINE and end - start > HOUR) else "note"
    return Stuck(start, end, value, whole=False, change=change, severity=severity)


def _some(values: Floats) -> Floats:
    """Return values at even distances, as many as show their distribution."""
    return values[:: values.size // LOOKED_AT + 1]


def _step(celsius: Floats) -> float:
    """Return the smallest difference between two readings, without those that are due to rounding."""
    gaps = np.diff(np.unique(celsius[:LOOKED_AT]))
    gaps = gaps[gaps > 1e-6]  # noqa: PLR2004 - °C, rounding of a conversion
    return float(gaps.min()) if gaps.size else 0.0


def _change(time: Floats, celsius: Floats, axes: Mapping[str, Channel], span: tuple[float, float]) -> float:
    """Return the largest change of temperature (°C) that a bias shows in the second half of a span; 0: none shows any."""
    most = 0.0
    for channel in axes.values():
        size = max(channel.values.size // BLOCKS, 1)
        count = channel.values.size // size
        mean = np.median(channel.values[: count * size].reshape(count, size), axis=1)
        at = channel.time[size // 2 : count * size : size][:count]
        # A sensor's die follows a thermometer late, so the first half of the span may change in earnest.
        inside = (at > (span[0] + span[1]) / 2) & (at < span[1])
        outside = (at < span[0]) | (at > span[1])
        warm = np.interp(at, time, celsius)
        if (
            inside.sum() < FEWEST
            or outside.sum() < FEWEST
            or np.ptp(warm[outside]) < WARMED
            or not np.ptp(mean[outside])
        ):
            continue
        slope, level = np.polyfit(warm[outside], mean[outside], 1)
        if abs(np.corrcoef(warm[outside], mean[outside])[0, 1]) < FOLLOWS:
            continue
        scatter = float(np.std(mean[outside] - level - slope * warm[outside]))
        moved = float(np.ptp(mean[inside]))
        if moved > SCATTERS * scatter:
            most = max(most, moved / abs(slope))
    return most if most > CHANGED else 0.0


def _range(values: Floats) -> str:
    low, high = float(values.min()), float(values.max())
    return f"{low:.4g}" if f"{low:.4g}" == f"{high:.4g}" else f"{low:.4g} to {high:.4g}"

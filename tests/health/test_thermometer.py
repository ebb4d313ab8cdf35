"""Faults of a thermometer: units, spikes, and readings that are stuck; a sound thermometer has none."""

from dataclasses import replace

import numpy as np
import pytest

from imuwb.health import check
from imuwb.log import SECOND, ImuStream, Log, Provenance, Scalars, Triad

HZ = 10  # of the IMU; its thermometer has a reading each second


def warmed(celsius, readings=None, seed=0, drift=0.02, faults=True):
    """Return the faults of an IMU whose gyro x follows a temperature (deg/s for each °C), one row for each second.

    ``readings`` are those of the thermometer, if they are not the temperature.
    """
    rng = np.random.default_rng(seed)
    celsius = np.asarray(celsius, float)
    n = celsius.size * HZ
    time = np.arange(n) * (SECOND // HZ)
    gyro, accel = 1e-3 * rng.standard_normal((n, 3)), 0.02 * rng.standard_normal((n, 3)) - [0, 0, 9.8]
    gyro[:, 0] += np.radians(drift) * (np.repeat(celsius, HZ) - 25)
    shown = celsius if readings is None else np.asarray(readings, float)
    thermometer = Scalars("/imu/temperature", time[::HZ], shown)
    imu = ImuStream("/imu", Triad(time, gyro), Triad(time, accel), thermometer)
    log = Log(Provenance("made.csv", "csv", "", 0), (imu,))
    return [f for f in check(log, lines=False).faults if f.stream == "/imu thermometer"] if faults else log


def ramp(seconds=3600, first=0.0, last=40.0, digits=3):
    return np.round(np.linspace(first, last, seconds), digits)


def kinds(*arguments, **given):
    return [(f.kind, f.severity) for f in warmed(*arguments, **given)]


@pytest.mark.parametrize("digits", [0, 1, 3])
@pytest.mark.parametrize("seconds", [300, 3600])
def test_a_thermometer_that_follows_the_sensor_has_no_fault(seconds, digits):
    assert kinds(ramp(seconds), ramp(seconds, digits=digits)) == []


@pytest.mark.parametrize("seed", range(20))
def test_noisy_readings_and_plateaus_have_no_fault(seed):
    rng = np.random.default_rng(seed)
    stairs = np.repeat([-20.0, 0.0, 20.0, 40.0], 900)
    felt = np.convolve(stairs, np.ones(120) / 120, "same")
    assert kinds(felt, np.round(stairs + 0.1 * rng.standard_normal(3600), 2)) == []


@pytest.mark.parametrize("digits", [0, 2])
def test_a_reading_that_stays_while_the_biases_change_is_stuck(digits):
    celsius = ramp()
    readings = np.where(np.arange(3600) < 1800, np.round(celsius, digits), np.round(celsius[1800], digits))
    (stuck,) = warmed(celsius, readings)
    assert (stuck.kind, stuck.severity) == ("stuck thermometer", "fault")
    assert stuck.start == pytest.approx(1800, abs=60)
    assert stuck.start + stuck.length == pytest.approx(3599, abs=1)
    assert "at 20" in stuck.what


@pytest.mark.parametrize("digits", [1, 3])
def test_a_steady_chamber_is_not_stuck_where_the_biases_are_steady_too(digits):
    celsius = np.concatenate([ramp(1200, 0, 20), np.full(2400, 20.0)])
    assert kinds(celsius, np.round(celsius, digits)) == [("stuck thermometer", "note")]


def test_a_fine_thermometer_does_not_stay_for_hours():
    celsius = np.concatenate([ramp(1200, 0, 20), np.full(5000, 20.0)])
    assert kinds(celsius) == [("stuck thermometer", "fault")]
    assert kinds(celsius, np.round(celsius)) == [("stuck thermometer", "note")]


@pytest.mark.parametrize(("minutes", "found"), [(9.5, []), (10.5, [("constant temperature", "note")]),
                                                (65, [("constant temperature", "fault")])])  # fmt: skip
def test_a_temperature_that_never_changes_was_not_measured(minutes, found):
    assert kinds(np.full(round(60 * minutes) + 1, 25.0)) == found


def test_a_simulator_may_keep_a_temperature():
    log = replace(warmed(np.full(4000, 25.0), faults=False), truth={"seed": "1"})
    assert [f.severity for f in check(log, lines=False).faults] == ["note"]


def test_the_thermometer_does_not_spoil_the_verdict_on_its_imu():
    found = check(warmed(ramp(), ramp() + 273.15, faults=False), lines=False)
    assert {s.name: s.verdict for s in found.streams} == {"/imu": "good", "/imu thermometer": "not usable as it is"}


@pytest.mark.parametrize(
    ("factor", "offset", "unit"),
    [(1, 273.15, "K"), (1.8, 32, "°F"), (100, 0, "cdegC"), (340, -36.53 * 340, "counts"), (1e6, 1e9, "unknown")],
)
def test_readings_that_no_imu_survives_are_of_another_unit(factor, offset, unit):
    celsius = ramp(first=-20, last=60)
    (fault,) = warmed(celsius, celsius * factor + offset)
    assert (fault.kind, fault.severity) == ("temperature unit", "fault")
    assert f"likely {unit}" in fault.consequence


@pytest.mark.parametrize(("top", "found"), [(84, []), (100, [("hot", "warning")])])
def test_a_hot_imu_is_asked_for_its_unit(top, found):
    assert kinds(ramp(last=top)) == found


@pytest.mark.parametrize(("value", "seconds"), [(85.0, 1), (-127.0, 3), (0.0, 8)])
def test_spikes_are_counted(value, seconds):
    readings = ramp(first=20)
    for at in (0, 700, 2000):
        readings[at : at + seconds] = value
    (spikes,) = warmed(ramp(first=20), readings)
    assert (spikes.kind, spikes.severity, spikes.count, spikes.start) == ("temperature spikes", "fault", 3 * seconds, 0)
    assert f"{value:g}" in spikes.what


@pytest.mark.parametrize("period", [5, 8, 30])
def test_spikes_that_follow_each_other_soon_are_counted(period):
    readings = ramp(first=20)
    readings[period // 2 :: period] = -273.15
    (spikes,) = warmed(ramp(first=20), readings)
    assert (spikes.kind, spikes.count) == ("temperature spikes", len(range(period // 2, readings.size, period)))


def test_a_step_of_the_temperature_is_no_spike():
    assert kinds(np.where(np.arange(3600) < 1800, ramp(), ramp() + 15)) == []

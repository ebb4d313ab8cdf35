"""A log without its sensors' deterministic terms: what is taken off, at which temperature, and only once."""

from dataclasses import replace

import numpy as np
import pytest

from imuwb.conditioning import correct, corrected_log
from imuwb.errors import MissingDataError, UsageError
from imuwb.log import ImuStream, Scalars, Triad
from imuwb.notes import ids
from imuwb.simulation import Temperature, drive, mixed_route
from imuwb.stochastic import AxisModel, ImuErrorModel, Sum, WhiteNoise, corrected

SECONDS, RATE = 100, 20
GYRO = AxisModel(
    bias=0.02, scale_factor=0.01, scale_factor_nonlinear=1e-3, range=5.0, g_sensitivity=(1e-4, -2e-4, 1e-4),
    thermal_bias=((-20.0, 0.02), (50.0, -0.03)),
)  # fmt: skip
ACCEL = AxisModel(bias=0.1, cross_coupling=(0.01, -0.02), thermal_scale_factor=((-20.0, -0.01), (50.0, 0.02)))
MODEL = ImuErrorModel(
    "terms",
    {a: GYRO if a[0] == "g" else ACCEL for a in ("gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z")},
)
PLAIN = replace(MODEL, axes={a: replace(m, thermal_bias=(), thermal_scale_factor=()) for a, m in MODEL.axes.items()})
IDEAL = ImuErrorModel("ideal", {})


def driven(model, celsius=None):
    return drive(
        model, mixed_route(SECONDS, 1), 1, rate=float(RATE), celsius=celsius or Temperature.ramp(-20.0, 50.0, SECONDS)
    )


@pytest.fixture(scope="module")
def truth():
    return driven(IDEAL).imus[0]


@pytest.fixture(scope="module")
def log():
    return driven(MODEL)


def with_imu(log, **changes):
    return replace(log, imus=(replace(log.imus[0], **changes),))


def triads(log):
    return log.imus[0].angular_rate.value, log.imus[0].specific_force.value


def held(time, known, values):
    """Return the last value known at each time, one by one."""
    return np.array([values[max(k for k in range(len(known)) if k == 0 or known[k] <= t)] for t in time])


def test_what_is_left_is_the_motion_at_the_temperature_that_was_known(log):
    imu = log.imus[0]
    celsius = held(imu.angular_rate.time, imu.temperature.time, imu.temperature.value)
    wanted = corrected(MODEL, triads(log), celsius)
    done, notes = corrected_log(log, MODEL)
    for got, known in zip(triads(done), wanted, strict=True):
        np.testing.assert_allclose(got, known, rtol=0, atol=1e-12)
    assert ids(notes) == ("corrected",)
    for term in ("bias", "scale factor", "non-linear scale factor", "cross-coupling", "g-sensitivity"):
        assert term in notes[0]
    assert "-20.0 to 49.3 °C" in notes[0]
    assert done.imus[0].temperature is imu.temperature
    assert done.conditioning[0].note == notes[0]


def test_a_temperature_of_every_sample_leaves_the_true_motion(log, truth):
    time = log.imus[0].angular_rate.time
    ramp = Temperature.ramp(-20.0, 50.0, SECONDS)
    exact = with_imu(log, temperature=Scalars("t", time, ramp.at((time - time[0]) / 1e9)))
    done, _ = corrected_log(exact, MODEL)
    assert np.abs(triads(done)[0] - truth.angular_rate.value).max() < 1e-9
    assert np.abs(triads(done)[1] - truth.specific_force.value).max() < 1e-9


@pytest.mark.parametrize("second", [10, 60])
def test_no_sample_knows_a_later_one(log, second):
    """It says that it is causal: whatever comes later, temperature or force, changes no earlier sample."""
    imu = log.imus[0]
    later = Triad(imu.specific_force.time[3::4] + 7_000_000, imu.specific_force.value[3::4])
    log = with_imu(log, specific_force=later)
    at = imu.angular_rate.time[0] + second * 1_000_000_000

    def hotter(stream, kind):
        return kind(stream.time, stream.value + (stream.time > at).reshape(-1, *(1,) * (stream.value.ndim - 1)) * 5.0)

    other = with_imu(
        log,
        specific_force=hotter(later, Triad),
        temperature=hotter(imu.temperature, lambda time, value: Scalars("t", time, value)),
    )
    one, two = corrected_log(log, MODEL)[0], corrected_log(other, MODEL)[0]
    for a, b in zip(
        (one.imus[0].angular_rate, one.imus[0].specific_force),
        (two.imus[0].angular_rate, two.imus[0].specific_force),
        strict=True,
    ):
        before = a.time <= at
        assert 0 < np.count_nonzero(before) < len(a)
        np.testing.assert_allclose(a.value[before], b.value[before], rtol=0, atol=1e-12)
        assert not np.array_equal(a.value, b.value)
    assert one.causal


def test_what_is_the_same_at_all_temperatures_needs_none(truth):
    log = with_imu(driven(PLAIN), temperature=None)
    done, notes = corrected_log(log, PLAIN)
    assert np.abs(triads(done)[0] - truth.angular_rate.value).max() < 1e-9
    assert np.abs(triads(done)[1] - truth.specific_force.value).max() < 1e-9
    assert "temperature" not in notes[0]


def test_without_a_temperature_the_plain_terms_are_taken_off_and_that_is_stated(truth):
    log = with_imu(driven(PLAIN), temperature=None)
    done, notes = corrected_log(log, MODEL)
    assert np.abs(triads(done)[0] - truth.angular_rate.value).max() < 1e-9
    assert "no temperature" in notes[0]


def test_without_a_temperature_and_plain_terms_nothing_is_taken_off(log):
    curves = ImuErrorModel("curves", {"gyro_x": AxisModel(thermal_bias=((-20.0, 0.02), (50.0, -0.03)))})
    cold = with_imu(log, temperature=None)
    done, notes = corrected_log(cold, curves)
    assert done is cold
    assert ids(notes) == ("uncorrected",)


def test_an_ideal_model_changes_nothing(log):
    noisy = ImuErrorModel("noise", {"gyro_x": AxisModel(Sum((WhiteNoise(1.0),)))})
    assert corrected_log(log, noisy) == (log, ())


def test_a_log_is_corrected_once(log):
    once, notes = corrected_log(log, MODEL)
    assert corrected_log(once, MODEL) == (once, notes)
    assert [step.name for step in once.conditioning] == ["error model"]
    conditioned, _ = correct(log, PLAIN, ("mine", "model=m.toml"))
    left, why = corrected_log(conditioned, MODEL)
    assert left is conditioned
    assert ids(why) == ("corrected-before",)
    assert "mine:model=m.toml" in why[0]


def test_gyros_with_a_g_sensitivity_need_a_force(log):
    with pytest.raises(MissingDataError, match=r"no accelerometer.* g-sensitivity"):
        corrected_log(with_imu(log, specific_force=None), MODEL)
    alone, _ = corrected_log(with_imu(log, angular_rate=None), MODEL)
    assert alone.imus[0].angular_rate is None
    np.testing.assert_array_equal(triads(corrected_log(log, MODEL)[0])[1], alone.imus[0].specific_force.value)


def test_only_the_first_imu_is_corrected(log):
    second = ImuStream("/other", log.imus[0].angular_rate, log.imus[0].specific_force)
    done, _ = corrected_log(replace(log, imus=(log.imus[0], second)), MODEL)
    assert done.imus[1] is second
    assert done.imus[0].name == log.imus[0].name
    assert not np.array_equal(done.imus[0].angular_rate.value, second.angular_rate.value)


def test_terms_that_hide_the_motion_are_refused(log):
    wild = ImuErrorModel("wild", {a: AxisModel(cross_coupling=(2.0, 2.0)) for a in ("gyro_x", "gyro_y", "gyro_z")})
    with pytest.raises(UsageError, match="wild: its scale factors"):
        corrected_log(log, wild)

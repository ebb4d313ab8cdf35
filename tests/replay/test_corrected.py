"""A log without its sensors' deterministic terms: what is taken off, at which temperature, and only once."""

from dataclasses import replace

import numpy as np
import pytest

from imuwb.errors import UsageError
from imuwb.log import Conditioning, ImuStream, Triad
from imuwb.navigation.filter_model import FilterModel
from imuwb.replay import corrected_log, prepare
from imuwb.simulation import Temperature, drive, mixed_route
from imuwb.stochastic import AxisModel, ImuErrorModel, Sum, WhiteNoise

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


def test_what_is_left_is_the_motion(log, truth):
    found, notes = corrected_log(log, MODEL)
    told = slice(0, (SECONDS - 1) * RATE + 1)  # the thermometer tells its last second after second
    for got, wanted in zip(triads(found), (truth.angular_rate.value, truth.specific_force.value), strict=True):
        assert np.abs(got[told] - wanted[told]).max() < 1e-9
    (note,) = notes
    assert "the model's bias, scale factor, non-linear scale factor, cross-coupling and g-sensitivity at" in note
    assert note.endswith("at the log's temperature of -20.0 to 49.3 °C")
    assert found.imus[0].temperature is log.imus[0].temperature


def test_what_is_the_same_at_all_temperatures_needs_none(truth):
    log = with_imu(driven(PLAIN), temperature=None)
    found, notes = corrected_log(log, PLAIN)
    assert np.abs(triads(found)[0] - truth.angular_rate.value).max() < 1e-9
    assert np.abs(triads(found)[1] - truth.specific_force.value).max() < 1e-9
    assert "temperature" not in notes[0]


def test_without_a_temperature_the_plain_terms_are_taken_off_and_that_is_said(truth):
    log = with_imu(driven(PLAIN), temperature=None)
    found, notes = corrected_log(log, MODEL)
    assert np.abs(triads(found)[0] - truth.angular_rate.value).max() < 1e-9
    assert "at the plain values beside its curves, as the log has no temperature" in notes[0]


def test_an_ideal_model_changes_nothing(log):
    noisy = ImuErrorModel("noise", {"gyro_x": AxisModel(Sum((WhiteNoise(1.0),)))})
    assert corrected_log(log, noisy) == (log, ())


def test_a_log_is_corrected_once(log):
    once, notes = corrected_log(log, MODEL)
    assert corrected_log(once, MODEL) == (once, notes)
    assert [step.name for step in once.conditioning] == ["error model"]
    assert once.causal
    conditioned = replace(log, conditioning=(Conditioning("correction", "model=m.toml", causal=True, delay=0.0),))
    left, said = corrected_log(conditioned, MODEL)
    assert left is conditioned
    assert "went through correction (model=m.toml)" in said[0]


def test_an_accelerometer_of_its_own_clock_leaks_into_gyros_as_it_then_is(log, truth):
    later = log.imus[0].specific_force
    half = Triad(later.time[1::2] + 7_000_000, later.value[1::2])
    found, _ = corrected_log(with_imu(log, specific_force=half), MODEL)
    inside = slice(20, -40)
    # g-sensitivity of 2e-4 rad/s per m/s², of a force that is known to some tenths of a m/s² between samples
    assert np.abs(triads(found)[0] - truth.angular_rate.value)[inside].max() < 1e-4
    alone, _ = corrected_log(with_imu(log, specific_force=None), MODEL)
    assert alone.imus[0].specific_force is None
    assert np.abs(triads(found)[1] - truth.specific_force.value[1::2])[10:-20].max() < 1e-3


def test_only_the_first_imu_is_corrected(log):
    second = ImuStream("/other", log.imus[0].angular_rate, log.imus[0].specific_force)
    found, _ = corrected_log(replace(log, imus=(log.imus[0], second)), MODEL)
    assert found.imus[1] is second
    assert found.imus[0].name == log.imus[0].name


def test_terms_that_hide_the_motion_are_refused(log):
    wild = ImuErrorModel("wild", {a: AxisModel(cross_coupling=(2.0, 2.0)) for a in ("gyro_x", "gyro_y", "gyro_z")})
    with pytest.raises(UsageError, match="wild: its scale factors"):
        corrected_log(log, wild)


def test_filters_take_corrected_samples_and_say_so(log, truth):
    noisy = {a: replace(m, processes=Sum((WhiteNoise(1e-3),))) for a, m in MODEL.axes.items()}
    model = FilterModel("known", replace(MODEL, axes=noisy))
    prepared = prepare(log, model)
    assert any("corrected by the model's bias" in note for note in prepared.notes)
    angle = prepared.moves.samples.angle * RATE
    told = slice(0, (SECONDS - 1) * RATE)
    assert np.abs(angle - truth.angular_rate.value)[told].max() < 1e-6
    before, _ = corrected_log(log, MODEL)
    again = prepare(before, model)
    assert np.array_equal(again.moves.samples.angle, prepared.moves.samples.angle)
    assert again.notes == prepared.notes

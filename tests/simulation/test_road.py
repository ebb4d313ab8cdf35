"""A rough road: its profile, the motion of the body over it, and the vibration that it causes."""

import numpy as np
import pytest
from scipy import signal

from imuwb.errors import UsageError
from imuwb.navigation import mechanize, navigation_state
from imuwb.simulation import Road, RoadVibration, Suspension, drive, mixed_route, preset
from imuwb.simulation.roughness import STEP, tracks
from imuwb.simulation.suspension import FINE
from imuwb.stochastic import ImuErrorModel

IDEAL = ImuErrorModel("ideal", {})
SIGMAS = 5  #: a right simulator fails one of a million such checks
STIFF = RoadVibration(0.0, 0.0)


@pytest.fixture(scope="module")
def route():
    return mixed_route(240, 2)


def welch(values, rate, length):
    """Return frequencies, one-sided density, and its relative sigma in a bin, of (n,) values."""
    f, power = signal.welch(values, rate, "hann", length, detrend=False)
    return f, power, np.sqrt(1.0 / (values.size / length))  # segments that overlap by half tell a little more


# The profile


@pytest.mark.parametrize(("name", "density"), [("A", 16e-6), ("C", 256e-6), ("E", 4096e-6)])
def test_the_profile_has_the_density_of_its_class(name, density):
    assert Road(name).density == density
    elevation = tracks(density, 40_000.0, 1.5, np.random.default_rng(3))
    for track in elevation.T:
        n, found, relative = welch(track, 1 / STEP, 8192)  # 1/m
        for least, most in ((0.03, 0.1), (0.1, 0.3), (0.3, 1.0), (1.0, 2.83)):
            band = (n > least) & (n < most)
            expected = density * 0.01 / (n[band] ** 2 + 0.011**2)
            ratio = (found[band] / expected).mean()
            # A sampled profile has its density plus that of its aliases: at 2.83 of 10 1/m, 3 %.
            assert ratio == pytest.approx(1, abs=SIGMAS * relative / np.sqrt(band.sum() / 2) + 0.03)


def test_both_tracks_rise_over_long_waves_and_differ_over_short_ones():
    elevation = tracks(256e-6, 40_000.0, 1.5, np.random.default_rng(1))
    n, cross = signal.csd(*elevation.T, 1 / STEP, "hann", 8192, detrend=False)
    both = [signal.welch(track, 1 / STEP, "hann", 8192, detrend=False)[1] for track in elevation.T]
    coherence = cross.real / np.sqrt(both[0] * both[1])
    p = 0.2 / 1.5
    for least, most in ((0.01, 0.03), (0.1, 0.17), (0.8, 1.0)):
        band = (n > least) & (n < most)
        assert coherence[band].mean() == pytest.approx((p**2 / (n[band] ** 2 + p**2)).mean(), abs=0.05)


# The body


def test_the_body_bounces_at_one_hertz_and_the_wheels_hop_at_eleven():
    k, t, m = 63.3, 653.0, 0.15
    poles = np.roots(Suspension(damper=0.1).transfer_function()[1])
    found = np.sort(np.abs(poles))[::2] / (2 * np.pi)
    assert found == pytest.approx(
        [np.sqrt(k * t / (k + t)) / (2 * np.pi), np.sqrt((k + t) / m) / (2 * np.pi)], rel=0.02
    )
    assert 1 < found[0] < 2
    assert 10 < found[1] < 15


@pytest.mark.parametrize("frequency", [0.2, 1.2, 11.0])
def test_the_body_answers_a_wave_as_its_transfer_function_says(frequency):
    suspension = Suspension()
    t = np.arange(20_000) / FINE
    body = suspension.response(np.sin(2 * np.pi * frequency * t))[10_000:]
    numerator, denominator = suspension.transfer_function()
    s = 2j * np.pi * frequency
    expected = abs(np.polyval(numerator, s) / np.polyval(denominator, s))
    assert np.abs(body).max() == pytest.approx(expected, rel=0.02)


def test_a_standing_car_is_still_and_a_moving_one_sways(route):
    ride = Road("C").under(route).ride
    still, moving = np.arange(0, 55, 0.01), np.arange(100, 230, 0.01)
    assert np.abs(ride.at(still, 1)).max() < 1e-9
    heave, roll, pitch = ride.at(moving, 2)[:, 0], *ride.at(moving, 1)[:, 1:].T
    assert 0.1 < heave.std() < 3  # m/s²
    assert 0.2 < np.degrees(roll.std()) < 10  # deg/s
    assert 0.2 < np.degrees(pitch.std()) < 10


def test_motion_grows_with_the_root_of_the_density(route):
    at = np.arange(100, 230, 0.05)
    smooth, rough = (Road(name, seed=5).under(route).ride.at(at) for name in ("B", "D"))
    assert rough == pytest.approx(4 * smooth, rel=1e-6)


@pytest.mark.parametrize("rate", [100, 200])
def test_an_ideal_imu_is_led_by_its_samples_along_the_truth(route, rate):
    ridden = Road("C", seed=1).under(route)
    rates, forces = ridden.averages(240 * rate, rate)
    start, end = 120 * rate, 180 * rate
    begin, truth = ridden.state(np.array([start / rate])), ridden.state(np.array([end / rate]))
    first = navigation_state(begin.position[0], begin.velocity[0], begin.attitude[0])
    part = slice(start + 1, end + 1)
    track = mechanize(first, np.full(end - start, 1 / rate), rates[part] / rate, forces[part] / rate)
    away = (track[-1, :3] - truth.position[0]) * (6.37e6, 4.5e6, 1)  # m
    assert np.abs(away).max() < 5e-3
    assert track[-1, 3:6] == pytest.approx(truth.velocity[0], abs=1e-3)


def test_the_truth_holds_the_motion_of_the_body(route):
    smooth, rough = (drive(IDEAL, route, 1, road=road, truth_rate=50) for road in (None, Road("C", vibration=STIFF)))
    (before,), (after,) = smooth.references, rough.references
    heave = after.position[:, 2] - before.position[:, 2]
    assert 1e-3 < heave.std() < 0.1
    rise = np.gradient(heave, 1 / 50)
    assert np.abs(rise + after.velocity[:, 2] - before.velocity[:, 2])[1:-1].max() < 0.05 * np.abs(rise).max()
    assert 0.05 < np.degrees(np.std(after.attitude[:, 1] - before.attitude[:, 1])) < 2
    assert np.array_equal(after.position[:, :2], before.position[:, :2])
    assert np.ptp(rough.gnss[0].position[:, 2] - smooth.gnss[0].position[:, 2]) > 1e-3


def test_the_road_belongs_to_its_own_seed(route):
    logs = [drive(IDEAL, route, seed, road=Road(seed=road)) for seed, road in ((1, 1), (2, 1), (1, 2))]
    attitudes = [log.references[0].attitude for log in logs]
    assert np.array_equal(attitudes[0], attitudes[1])
    assert not np.array_equal(attitudes[0], attitudes[2])
    assert len({log.provenance.hash for log in logs}) == 3


# The vibration


@pytest.mark.parametrize(
    ("rate", "bandwidth"), [(50.0, None), (100.0, None), (100.0, 40.0), (200.0, None), (200.0, 90.0)]
)
def test_aliased_vibration_acts_as_the_white_noise_that_is_stated(rate, bandwidth):
    vibration = RoadVibration()
    values = 0.01 * vibration.sample(1 << 18, rate, bandwidth, np.random.default_rng(2))
    f, power, relative = welch(values, rate, 1 << 12)
    low = (f > 0.1) & (f < 2.0)
    found = power[low].mean() / 2  # two-sided
    assert found == pytest.approx(
        vibration.density(0.01, rate, bandwidth) ** 2, rel=SIGMAS * relative / np.sqrt(low.sum() / 2) + 0.02
    )
    cells = int(2 * rate)  # 2 s: an Allan variance is N² / tau
    means = values[: values.size // cells * cells].reshape(-1, cells).mean(axis=1)
    allan = (np.diff(means) ** 2).mean() / 2 * 2.0
    assert allan == pytest.approx(vibration.density(0.01, rate, bandwidth) ** 2, rel=SIGMAS * np.sqrt(4 / means.size))


def test_samples_faster_than_twice_the_band_have_next_to_no_noise_near_zero():
    vibration = RoadVibration()
    assert vibration.density(0.01, 1000.0, None) == 0
    assert vibration.density(0.01, 100.0, None) > 40 * vibration.density(0.01, 400.0, None)
    assert vibration.sample(20_000, 1000.0, None, np.random.default_rng(0)).std() == pytest.approx(1, rel=0.05)


def test_vibration_grows_with_the_speed_and_the_road():
    vibration = RoadVibration(exponent=0.5, idle=0.1)
    level = vibration.level(np.array([0.0, 15.0, 30.0]), 256e-6)
    assert level == pytest.approx(np.sqrt([0.01, 1.01, 2.01]))
    assert vibration.level(np.array([15.0]), 4 * 256e-6) == pytest.approx(np.sqrt(4.01))


@pytest.mark.parametrize("grade", ["mpu-6050", "3dm-gx3-25", "stim300"])
def test_a_drive_has_the_noise_in_motion_that_its_log_states(route, grade):
    model = preset(grade)
    road = Road("C", seed=3)
    rough = drive(model, route, 5, road=road)
    quiet = drive(model, route, 5, road=Road("C", seed=3, vibration=STIFF))
    moving = route.speed(np.arange(len(rough.imus[0].angular_rate)) / 100) > 0.1
    for triad, name in (("angular_rate", "gyro"), ("specific_force", "accel")):
        error = getattr(rough.imus[0], triad).value - getattr(quiet.imus[0], triad).value
        value, unit = rough.truth[f"road.vibration.{name}.N"].split()
        assert unit == {"gyro": "rad/s/√Hz", "accel": "m/s²/√Hz"}[name]
        means = error[moving][: moving.sum() // 20 * 20].reshape(-1, 20, 3).mean(axis=1)  # 0.2 s
        allan = (np.diff(means, axis=0) ** 2).mean() / 2 * 0.2
        assert allan == pytest.approx(float(value) ** 2, rel=SIGMAS * np.sqrt(4 / means.size) + 0.05)
        assert error[:5500].std() < 0.2 * error[moving].std()
    assert 2e-4 < float(rough.truth["road.vibration.gyro.N"].split()[0]) < 2e-3
    assert float(rough.truth["road.Gd(n0)"].split()[0]) == 256e-6


@pytest.mark.parametrize(
    "make",
    [
        lambda: Road("F"), lambda: Road(0.0), lambda: Road(np.nan), lambda: Suspension(damper=0), lambda: Suspension(track=0.1),
        lambda: RoadVibration(accel=-1), lambda: RoadVibration(band=(250, 20)), lambda: RoadVibration(exponent=5),
        lambda: RoadVibration(idle=np.nan), lambda: drive(IDEAL, mixed_route(90), 0, rate=40, road=Road()),
    ],
)  # fmt: skip
def test_what_cannot_be_is_refused(make):
    with pytest.raises(UsageError):
        make()

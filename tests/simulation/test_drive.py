"""Drives: the route, its truth against an integration in another frame, and the sensors' errors."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import signal

from imuwb.errors import UsageError
from imuwb.geodesy.attitude import rotation_of_euler
from imuwb.readers import read
from imuwb.simulation import Odometer, Receiver, drive, mixed_route, planned_outages, planned_route, preset
from imuwb.stochastic import AxisModel, ImuErrorModel
from imuwb.writers import write

from .. import ecef  # noqa: TID252 - tests are no package that has a name

IDEAL = ImuErrorModel("ideal", {})
SILENT = Receiver(position_sigma=(0, 0, 0), velocity_sigma=(0, 0, 0))
PUBLISHED = {
    "turin-1": {(9, 1): (30, 23.58), (9, 2): (60, 42.31), (9, 3): (30, 47.60),
                (6, 1): (30, 25.16), (6, 2): (30, 18.86), (6, 3): (30, 42.53)},
    "turin-2": {(10, 4): (30, 33.60), (10, 5): (30, 52.25), (10, 6): (30, 20.44), (10, 7): (60, 112.42),
                (6, 4): (30, 23.56), (6, 5): (30, 39.32), (6, 6): (60, 103.36), (6, 7): (60, 122.73)},
}  # fmt: skip


@pytest.fixture(scope="module")
def town():
    return planned_route("turin-1")


@pytest.fixture(scope="module")
def short():
    return mixed_route(240)


def every(route, step=0.05):
    return np.arange(0, route.duration, step)


def ned_distance(found, truth):
    """Return (n, 3) m from positions to others near by."""
    axes = ecef.local_axes(*truth[0, :2])
    return (ecef.cartesian(found) - ecef.cartesian(truth)) @ axes


# The plan


@pytest.mark.parametrize("name", PUBLISHED)
def test_outages_are_the_published_ones_apart_and_late_enough(name):
    outages = planned_outages(name)
    assert {(o.table, o.number): (o.duration, pytest.approx(o.speed * 3.6)) for o in outages} == PUBLISHED[name]
    ends = [160, *(o.start + o.duration for o in outages)]
    assert all(o.start >= before + 20 for o, before in zip(outages, ends, strict=False))
    assert ends[-1] <= planned_route(name).duration


@pytest.mark.parametrize("seed", [0, 1, 7])
@pytest.mark.parametrize("name", PUBLISHED)
def test_mean_speeds_and_turns_in_the_outages_are_as_told(name, seed):
    route = planned_route(name, seed)
    turned = {}
    for outage in planned_outages(name):
        t = np.linspace(outage.start, outage.start + outage.duration, 6001)
        state = route.state(t)
        horizontal = np.trapezoid(np.hypot(*state.velocity[:, :2].T), t) / outage.duration
        assert horizontal == pytest.approx(outage.speed, rel=0.002)
        heading = np.degrees(np.unwrap(state.attitude[:, 2]))
        turned[outage.table, outage.number] = abs(heading[-1] - heading[0])
    told = {(9, 1): 90, (10, 5): 90, (10, 7): 12}
    assert all(angle == pytest.approx(told.get(key, 0), abs=3) for key, angle in turned.items())


def test_a_slight_curve_comes_at_the_end_of_the_fastest_paper_outage():
    outage = planned_outages("turin-2")[-1]
    t = outage.start + np.array([0.0, 45.0, 60.0])
    heading = np.degrees(np.unwrap(planned_route("turin-2").state(t).attitude[:, 2]))
    assert abs(heading[1] - heading[0]) < 2
    assert abs(heading[2] - heading[1]) > 9


# The motion


@pytest.mark.parametrize("seed", [0, 3])
@pytest.mark.parametrize(
    "make",
    [lambda s: planned_route("turin-1", s), lambda s: planned_route("turin-2", s), lambda s: mixed_route(1800, s)],
)
def test_it_moves_as_a_car_does(make, seed):
    route = make(seed)
    t = every(route)
    speed, state = route.speed(t), route.state(t)
    assert (speed[t <= 60] == 0).all()
    assert (speed >= 0).all()
    assert 45 / 3.6 < speed.max() < 130 / 3.6
    along = np.gradient(speed, t)
    across = speed * np.gradient(np.unwrap(state.attitude[:, 2]), t)
    assert np.abs(along).max() < 3
    assert 1 < np.abs(across).max() < 4
    assert np.abs(state.attitude[:, :2]).max() < 0.08
    stops = np.flatnonzero(np.diff((speed == 0).astype(int)) == 1)
    assert stops.size >= 1


def test_long_routes_know_town_country_road_and_highway():
    speed = mixed_route(3600).speed(np.arange(0, 3600, 1.0)) * 3.6
    for low, high in ((10, 50), (60, 90), (100, 130)):
        assert ((speed > low) & (speed < high)).mean() > 0.1


@pytest.mark.slow
@pytest.mark.parametrize("name", PUBLISHED)
def test_motion_lies_below_five_hertz(name):
    rate, force = planned_route(name).averages(60_000, 100)
    for values in (rate, force):
        f, power = signal.periodogram(values - values.mean(axis=0), 100, window="blackmanharris", axis=0)
        assert (power[f > 5].sum(axis=0) < 1e-6 * power.sum(axis=0)).all()


def test_before_the_start_it_stands_and_behind_the_end_there_is_nothing(town):
    early, start = town.state(np.array([-5.0])), town.state(np.array([0.0]))
    assert np.array_equal(early.position, start.position)
    assert not early.velocity.any()
    with pytest.raises(ValueError, match="1038"):
        town.state(np.array([town.duration + 1]))


# The truth


@pytest.mark.slow
def test_the_truth_is_met_by_an_integration_in_another_frame():
    route = planned_route("turin-2")
    end = route.duration - 300
    start = route.state(np.array([end]))
    first = (start.position[0], start.velocity[0], start.attitude[0])
    time, position, velocity, attitude = ecef.strapdown(route.inertial, end, route.duration, *first)
    truth = route.state(time)
    assert np.linalg.norm(position - ecef.cartesian(truth.position), axis=1).max() < 1e-3
    for i in range(time.size):
        axes = ecef.local_axes(*truth.position[i, :2])
        assert velocity[i] == pytest.approx(axes @ truth.velocity[i], abs=1e-5)
        assert attitude[i] == pytest.approx(axes @ ecef.body_axes(*truth.attitude[i]), abs=1e-8)


def test_a_sample_is_the_average_over_the_interval_that_ends_at_its_stamp(short):
    imu = drive(IDEAL, short, 0).imus[0]
    k = np.array([0, 9000, 12_345])
    fine = (k[:, None] - 1 + (np.arange(1000) + 0.5) / 1000) / 100
    for triad, felt in zip((imu.angular_rate, imu.specific_force), short.inertial(fine.ravel()), strict=True):
        assert triad.value[k] == pytest.approx(felt.reshape(3, 1000, 3).mean(axis=1), abs=1e-9)


def test_a_standing_imu_feels_gravity_and_the_earth(short):
    (rate,), (force,) = short.inertial(np.array([10.0]))
    assert np.linalg.norm(rate) == pytest.approx(7.292115e-5, rel=1e-9)
    assert np.linalg.norm(force) == pytest.approx(9.8055, abs=1e-3)  # of 45 degrees, 240 m up


def test_truth_stands_at_samples_of_the_imu(short):
    log = drive(IDEAL, short, 0, rate=125, truth_rate=10)
    (truth,), imu = log.references, log.imus[0]
    assert np.isin(truth.time, imu.angular_rate.time).all()
    assert np.diff(truth.time).mean() == pytest.approx(0.1e9, rel=0.05)
    state = short.state(log.seconds(truth.time))
    assert truth.position == pytest.approx(state.position, abs=1e-13)
    assert truth.attitude == pytest.approx(state.attitude, abs=1e-8)


# Receiver and odometer


@pytest.mark.slow
def test_fixes_scatter_and_claim_what_the_receiver_says(town):
    receiver = Receiver(5.0, (1.0, 2.0, 3.0), (0.1, 0.2, 0.3))
    (gnss,) = drive(IDEAL, town, 3, receiver=receiver).gnss
    truth = town.state(np.arange(len(gnss)) / 5)
    for errors, sigmas, claimed in (
        (ned_distance(gnss.position, truth.position), receiver.position_sigma, gnss.position_sigma),
        (gnss.velocity - truth.velocity, receiver.velocity_sigma, gnss.velocity_sigma),
    ):
        assert errors.std(axis=0) == pytest.approx(sigmas, rel=0.04)
        assert np.abs(errors.mean(axis=0) / sigmas).max() < 4 / np.sqrt(len(gnss))
        assert set(map(tuple, claimed)) == {sigmas}
        assert np.abs(np.corrcoef(errors[1:, 0], errors[:-1, 0])[0, 1]) < 4 / np.sqrt(len(gnss))
    assert set(gnss.fix_type) == {3}


@pytest.mark.slow
def test_a_late_fix_shows_where_the_car_was(short):
    late = drive(IDEAL, short, 0, receiver=replace(SILENT, latency=0.15)).gnss[0]
    then = short.state(np.arange(len(late)) - 0.15)
    assert late.time[0] == drive(IDEAL, short, 0).imus[0].angular_rate.time[0]
    assert np.abs(ned_distance(late.position, then.position)).max() < 1e-6
    assert late.velocity == pytest.approx(then.velocity, abs=1e-12)


def test_the_antenna_turns_with_the_car(short):
    arm = (1.5, -0.5, -1.2)
    fixes = drive(IDEAL, short, 0, receiver=replace(SILENT, rate=50, lever_arm=arm)).gnss[0]
    t = np.arange(len(fixes)) / 50
    truth = short.state(t)
    ned = rotation_of_euler(truth.attitude) @ np.array(arm)
    assert np.abs(ned_distance(fixes.position, truth.position) - ned).max() < 3e-3  # axes of the first place
    # What moves is what the velocity says, also of the arm alone.
    moved = np.gradient(ned, t, axis=0)
    swing = fixes.velocity - truth.velocity
    assert np.abs(swing).max() > 0.1
    assert np.abs(swing - moved)[1:-1].max() < 2e-3


def test_an_odometer_shows_the_speed_in_steps(short):
    (speeds,) = drive(IDEAL, short, 0, odometer=Odometer(scale_error=0.02, step=0.1)).speeds
    truth = short.speed(np.arange(len(speeds)) / 10)
    assert np.abs(speeds.value - 1.02 * truth).max() <= 0.05 + 1e-12
    assert speeds.value / 0.1 == pytest.approx(np.rint(speeds.value / 0.1), abs=1e-9)
    assert drive(IDEAL, short, 0).speeds == ()


# Sensors


def test_errors_come_on_top_of_the_motion(short):
    model = preset("3dm-gx3-25")
    ideal, real = (drive(m, short, 4).imus[0] for m in (IDEAL, model))
    errors = real.angular_rate.value - ideal.angular_rate.value
    expected = np.sqrt([model.axes[f"gyro_{a}"].processes.allan_variance(np.array([0.01]), 0.01)[0] for a in "xyz"])
    assert np.diff(errors, axis=0).std(axis=0) / np.sqrt(2) == pytest.approx(expected, rel=0.02)


@pytest.mark.slow
def test_deterministic_terms_follow_the_motion(short):
    gyro = AxisModel(scale_factor=0.01, g_sensitivity=(0, 1e-3, 0), cross_coupling=(0.1, 0))
    ideal, real = (drive(m, short, 0).imus[0] for m in (IDEAL, ImuErrorModel("bent", {"gyro_z": gyro})))
    rate, force = ideal.angular_rate.value, ideal.specific_force.value
    expected = 1.01 * rate[:, 2] + 0.1 * rate[:, 0] + 1e-3 * force[:, 1]
    assert real.angular_rate.value[:, 2] == pytest.approx(expected, abs=1e-15)
    assert np.array_equal(real.specific_force.value, force)


@pytest.mark.slow
def test_vibration_is_strong_as_told_between_5_and_50_hertz(short):
    calm, shaken = (drive(IDEAL, short, 0, rate=200, vibration=v).imus[0] for v in (0, 0.5))
    force = shaken.specific_force.value - calm.specific_force.value
    assert np.sqrt((force**2).mean(axis=0)) == pytest.approx(0.5, rel=0.02)
    f, power = signal.welch(force[:, 0], 200, nperseg=4096)
    assert power[(f > 1) & (f < 2)].max() < 1e-3 * power[(f > 10) & (f < 40)].mean()
    assert f[np.argmax(power)] == pytest.approx(27, abs=0.1)
    assert shaken.angular_rate.value.std() > calm.angular_rate.value.std()


# Seeds


def same_noise(one, other):
    return np.array_equal(one.imus[0].angular_rate.value, other.imus[0].angular_rate.value)


def test_seeds_of_noise_and_of_the_route_do_what_they_say():
    model, first = preset("mpu-6050"), mixed_route(120, 1)
    log, again, noise = (drive(model, mixed_route(120, 1), seed) for seed in (1, 1, 2))
    assert same_noise(log, again)
    assert np.array_equal(log.gnss[0].position, again.gnss[0].position)
    assert log.provenance.hash == again.provenance.hash != noise.provenance.hash
    assert not same_noise(log, noise)
    assert not np.array_equal(log.gnss[0].position, noise.gnss[0].position)
    assert np.array_equal(log.references[0].position, noise.references[0].position)
    elsewhere = drive(model, mixed_route(120, 2), 1)
    assert not np.array_equal(elsewhere.references[0].position, log.references[0].position)
    assert elsewhere.provenance.hash != log.provenance.hash
    assert first.duration == 120


@pytest.mark.parametrize("name", PUBLISHED)
def test_another_route_seed_turns_and_stops_elsewhere(name):
    one, other = (planned_route(name, seed) for seed in (0, 1))
    t = np.arange(0, one.duration, 1.0)
    assert np.hypot(*ned_distance(one.state(t).position, other.state(t).position)[-1, :2]) > 100
    assert not np.array_equal(one.speed(t) == 0, other.speed(t) == 0)


# Files and the command line


def test_every_stream_survives_mcap(short, tmp_path):
    log = drive(preset("mpu-6050"), short, 1, odometer=Odometer(), receiver=Receiver(lever_arm=(1, 0, -1)))
    paths = [tmp_path / name for name in ("a.mcap", "b.mcap")]
    for path in paths:
        write(log, path)
    assert paths[0].read_bytes() == paths[1].read_bytes()
    found = read(paths[0])
    assert np.array_equal(found.imus[0].angular_rate.value, log.imus[0].angular_rate.value)
    assert np.array_equal(found.imus[0].specific_force.value, log.imus[0].specific_force.value)
    for name in ("position", "velocity", "attitude"):
        assert np.array_equal(getattr(found.references[0], name), getattr(log.references[0], name))
    assert np.array_equal(found.speeds[0].value, log.speeds[0].value)
    for name in ("position", "velocity", "position_sigma", "velocity_sigma", "fix_type"):
        assert getattr(found.gnss[0], name) == pytest.approx(getattr(log.gnss[0], name), rel=1e-14, abs=1e-15)
    assert found.references[0].name == "truth"


@pytest.mark.parametrize(
    ("make", "why"),
    [
        (lambda: planned_route("rome"), "turin-1, turin-2"),
        (lambda: planned_outages("rome"), "turin-1, turin-2"),
        (lambda: mixed_route(89), "90 to 86400"),
        (lambda: mixed_route(86_401), "90 to 86400"),
        (lambda: mixed_route(float("nan")), "90 to 86400"),
        (lambda: Receiver(rate=0), "rate"),
        (lambda: Receiver(position_sigma=(1, -1, 1)), "sigma"),
        (lambda: Receiver(latency=float("nan")), "latency"),
        (lambda: Receiver(lever_arm=(0, 0, 1e6)), "lever arm"),
        (lambda: Odometer(scale_error=2), "scale error"),
        (lambda: drive(IDEAL, mixed_route(90), 0, rate=5), "20 to 10000"),
        (lambda: drive(IDEAL, mixed_route(90), 0, truth_rate=0), "truth"),
        (lambda: drive(IDEAL, mixed_route(90), 0, rate=50, vibration=1), "60 Hz or more"),
        (lambda: drive(IDEAL, mixed_route(90), 0, celsius=-300), "-273.15"),
    ],
)
def test_what_cannot_be_is_refused_with_its_reason(make, why):
    with pytest.raises(UsageError, match=why):
        make()

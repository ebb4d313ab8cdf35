"""When receivers and odometers show that the vehicle travels, and that noise at rest shows nothing."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from imuwb.geodesy import radii_of_curvature
from imuwb.log import BY_FILTER, SECOND, GnssStream, ImuStream, Log, Origin, Provenance, Reference, Scalars, Triad
from imuwb.navigation.travel import travels

N, RATE = 1200, 5
T = np.arange(N) / RATE


def track(north, **given):
    """Return a receiver on a meridian at some m to the north over time, with its true velocity."""
    meridian = radii_of_curvature(np.array([0.8]))[0][0]
    position = np.stack([0.8 + north / meridian, np.full(N, 0.2), np.zeros(N)], axis=1)
    velocity = np.stack([np.gradient(north) * RATE, 0 * north, 0 * north], axis=1)
    return replace(GnssStream("/fix", np.arange(N) * (SECOND // RATE), position, velocity), **given)


def spans(*gnss, **streams):
    return travels(Log(Provenance("made.csv", "csv", "", 0), gnss=gnss, zero=0, **streams))


def noise(rng, sigma, correlation):
    """Return a first-order Gauss-Markov error of three axes, correlated over some s."""
    a = np.exp(-1 / RATE / correlation) if correlation else 0.0
    white = rng.standard_normal((N + 500, 3)) * sigma * np.sqrt(1 - a * a)
    return lfilter([1.0], [1.0, -a], white, axis=0)[500:]


@pytest.mark.parametrize("speed", [1.5, 20.0, -200.0])
def test_an_even_drive_is_one_travel(speed):
    assert spans(track(speed * T)) == pytest.approx(np.array([[0, T[-1]]]), abs=0.2)


@pytest.mark.parametrize(("sigma", "count"), [(0.05, 1), (None, 0)])
def test_a_slow_velocity_needs_a_sigma(sigma, count):
    stated = None if sigma is None else np.full((N, 3), sigma)
    assert len(spans(track(0.7 * T, velocity_sigma=stated))) == count


def test_a_stop_divides_it():
    found = spans(track(np.cumsum(np.where((T > 100) & (T < 150), 0.0, 10.0)) / RATE))
    assert found == pytest.approx(np.array([[0, 100], [150, T[-1]]]), abs=0.5)


@pytest.mark.parametrize("sigma", [None, 0.05])
def test_positions_alone_show_it(sigma):
    stated = None if sigma is None else np.full((N, 3), sigma)
    found = spans(track(np.where(T < 100, 0.0, 15.0 * (T - 100)), velocity=None, position_sigma=stated))
    assert found == pytest.approx(np.array([[100, T[-1]]]), abs=5)


@pytest.mark.parametrize(
    ("sigma", "correlation", "stated"),
    [(0.05, 0, None), (1.0, 0, None), (0.2, 2, None), (0.3, 5, None), (0.5, 10, 0.5)],
)
def test_the_velocity_of_a_simple_receiver_at_rest_shows_nothing(sigma, correlation, stated):
    wrong = 0.0
    for seed in range(50):
        velocity = noise(np.random.default_rng(seed), sigma, correlation)
        told = None if stated is None else np.full((N, 3), stated)
        wrong += np.ptp(spans(track(0 * T, velocity=velocity, velocity_sigma=told)), axis=1).sum()
    assert wrong / (50 * T[-1]) < 0.001


def test_positions_that_wander_at_rest_show_nothing():
    meridian = radii_of_curvature(np.array([0.8]))[0][0]
    wrong = 0.0
    for seed in range(50):
        still = track(0 * T, velocity=None)
        off = noise(np.random.default_rng(seed), 2.5, 60) / [meridian, meridian * np.cos(0.8), 1]
        wrong += np.ptp(spans(replace(still, position=still.position + off)), axis=1).sum()
    assert wrong / (50 * T[-1]) < 0.001


def test_spikes_of_the_velocity_are_no_travel():
    velocity = np.zeros((N, 3))
    velocity[::20, 0] = 494.0
    assert not len(spans(track(0 * T, velocity=velocity)))


def test_without_a_fix_nothing_is_shown():
    fix = np.where(T < 100, 1, 3)
    assert spans(track(20 * T, fix_type=fix)) == pytest.approx(np.array([[100, T[-1]]]), abs=0.2)


def test_an_unknown_velocity_is_not_zero():
    velocity = np.where((np.arange(N) % 3 == 0)[:, None], [[20.0, 0, np.nan]], np.nan)
    assert np.ptp(spans(track(20 * T, velocity=velocity))) == pytest.approx(T[-1], abs=1)


def test_a_climb_is_a_travel():
    assert len(spans(track(0 * T, velocity=np.tile([0, 0, -3.0], (N, 1))))) == 1


@pytest.mark.parametrize(("speed", "count"), [(0.05, 0), (-0.3, 1)])
def test_an_odometer_that_turns_shows_it(speed, count):
    time = np.arange(N) * (SECOND // RATE)
    assert len(spans(speeds=(Scalars("/wheel", time, np.full(N, speed)),))) == count


def test_a_receiver_that_stops_reporting_shows_nothing_after_it():
    stream = track(20 * T)
    kept = (T < 50) | (T > 150)
    cut = GnssStream("/fix", stream.time[kept], stream.position[kept], np.tile([20.0, 0, 0], (int(kept.sum()), 1)))
    assert spans(cut) == pytest.approx(np.array([[0, 50], [150, T[-1]]]), abs=0.5)


@pytest.mark.parametrize("receiver", [True, False])
def test_the_vehicle_s_own_filter_counts_only_alone(receiver):
    moving = track(20 * T)
    own = Reference("/ekf", moving.time, moving.position, moving.velocity, origin=Origin(frame=f"NED, {BY_FILTER}"))
    assert len(spans(*((track(0 * T),) if receiver else ()), references=(own,))) == (not receiver)


def test_times_count_from_the_log_s_start():
    stream = track(20 * T)
    imu = ImuStream("imu", Triad(np.array([-50 * SECOND, 0]), np.zeros((2, 3))), None)
    log = Log(Provenance("made.csv", "csv", "", 0), (imu,), gnss=(stream,))
    assert travels(log) == pytest.approx(np.array([[50, 50 + T[-1]]]), abs=0.2)

"""Errors of a receiver beyond white noise: correlation, multipath steps, delay, and claims."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from imuwb.errors import UsageError
from imuwb.geodesy.attitude import rotation_of_euler
from imuwb.geodesy.earth import radii_of_curvature
from imuwb.simulation import GnssErrors, Receiver, drive, mixed_route
from imuwb.stochastic import ImuErrorModel

IDEAL = ImuErrorModel("ideal", {})
SILENT = Receiver(position_sigma=(0, 0, 0), velocity_sigma=(0, 0, 0))
SIGMAS = 5  #: a right simulator fails one of a million such checks
QUIET = GnssErrors(step_rate=0.0)


@pytest.fixture(scope="module")
def route():
    return mixed_route(240)


def sampled(errors, count, rate, seed=0):
    return errors.sample(count, rate, np.random.default_rng(seed))


def distance(found, truth):
    """Return (n, 3) m, NED, from positions to others near by."""
    meridian, transverse = radii_of_curvature(truth[:, 0])
    north = (found[:, 0] - truth[:, 0]) * (meridian + truth[:, 2])
    east = (found[:, 1] - truth[:, 1]) * (transverse + truth[:, 2]) * np.cos(truth[:, 0])
    return np.stack([north, east, truth[:, 2] - found[:, 2]], axis=1)


# Correlation


def bartlett(lag, factor, count):
    """Return the sigma of the estimated autocorrelation of a first-order Gauss-Markov series (Bartlett 1946)."""
    square = factor**2
    spread = (1 + square) * (1 - square**lag) / (1 - square) - 2 * lag * square**lag
    return np.sqrt(spread / count)


@pytest.mark.parametrize("rate", [1.0, 5.0])
def test_correlated_errors_have_their_sigmas_and_correlation_times(rate):
    errors = GnssErrors((1.0, 2.0, 3.0), 20.0, (0.1, 0.2, 0.3), 5.0)
    count = 200_000
    for values, sigmas, time in zip(
        sampled(errors, count, rate), (errors.position_sigma, errors.velocity_sigma), (20, 5), strict=True
    ):
        factor = np.exp(-1 / (time * rate))
        of_variance = np.sqrt(2 * (1 + factor**2) / (1 - factor**2) / count)
        assert (values**2).mean(axis=0) == pytest.approx(np.square(sigmas), rel=SIGMAS * of_variance)
        for seconds in (1, time, 2 * time):
            lag = int(seconds * rate)
            found = (values[lag:] * values[:-lag]).mean(axis=0) / (values**2).mean(axis=0)
            assert found == pytest.approx(np.exp(-seconds / time), abs=SIGMAS * bartlett(lag, factor, count))
        assert np.abs(np.corrcoef(values.T) - np.eye(3)).max() < SIGMAS * of_variance


def test_the_first_error_has_the_same_sigma():
    errors = GnssErrors(position_sigma=(1.0, 1.0, 1.0), position_time=100.0)
    first = np.array([sampled(errors, 1, 1.0, seed)[0][0] for seed in range(1000)])
    assert (first**2).mean() == pytest.approx(1, rel=SIGMAS * np.sqrt(2 / first.size))


# Multipath


def test_multipath_steps_come_last_and_vary_as_stated():
    errors = GnssErrors(step_rate=2.0, step_sigma=(5.0, 4.0, 10.0), step_duration=6.0)
    drives = [sampled(errors, 1200, 2.0, seed)[0] for seed in range(400)]
    busy = np.array([(values[:, 0] != 0).mean() for values in drives])
    mean_steps = 2.0 / 60 * 6.0  # steps that act at an instant: Poisson
    spread = busy.std() / np.sqrt(busy.size)
    assert busy.mean() == pytest.approx(1 - np.exp(-mean_steps), abs=SIGMAS * spread)
    squares = np.array([(values**2).mean(axis=0) for values in drives])
    off = np.abs(squares.mean(axis=0) - mean_steps * np.square(errors.step_sigma))
    assert (off < SIGMAS * squares.std(axis=0) / np.sqrt(len(drives))).all()


def test_a_step_is_constant_and_lasts_as_stated():
    errors = GnssErrors(step_rate=0.2, step_duration=8.0)
    values = sampled(errors, 1_000_000, 10.0)[0][:, 0]
    edges = np.flatnonzero(np.diff(values)) + 1
    alone = [(a, b) for a, b in pairwise(edges) if values[a] and not values[a - 1] and not values[b]]
    assert len(alone) > 200
    # A step is alone if no other starts while it lasts; this makes the mean duration D of those seen D / (1 + D rate).
    expected = 8.0 / (1 + 8.0 * 0.2 / 60)
    lengths = np.array([b - a for a, b in alone]) / 10
    assert lengths.mean() == pytest.approx(expected, abs=SIGMAS * expected / np.sqrt(lengths.size))


def test_velocities_have_no_steps():
    assert not sampled(GnssErrors(step_rate=30.0), 1000, 1.0)[1].any()


# In a drive


def fixes(route, receiver):
    return drive(IDEAL, route, 1, receiver=receiver).gnss[0]


def test_errors_come_on_top_of_the_white_noise(route):
    errors = GnssErrors((3.0, 3.0, 6.0), 30.0, (0.2, 0.2, 0.4), 3.0, step_rate=3.0)
    plain, more = (fixes(route, Receiver(4.0, errors=e)) for e in (QUIET, errors))
    added = distance(more.position, plain.position)
    assert 1.5 < added[:, :2].std() < 9
    assert 0.1 < (more.velocity - plain.velocity)[:, :2].std() < 0.4
    assert more.position_sigma[0] == pytest.approx(np.hypot((2.0, 2.0, 3.5), (3.0, 3.0, 6.0)))
    assert more.velocity_sigma[0] == pytest.approx(np.hypot((0.1, 0.1, 0.15), (0.2, 0.2, 0.4)))


def test_claims_are_the_true_sigmas_over_the_factors(route):
    plain, bold = (fixes(route, Receiver(errors=GnssErrors(claim=c))) for c in ((1.0, 1.0), (4.0, 0.5)))
    assert bold.position_sigma == pytest.approx(plain.position_sigma / 4)
    assert bold.velocity_sigma == pytest.approx(plain.velocity_sigma * 2)
    assert np.array_equal(bold.position, plain.position)


def test_fixes_are_late_by_the_latency_and_its_jitter(route):
    receiver = replace(SILENT, rate=10.0, latency=0.5, errors=GnssErrors(jitter=0.05))
    late = fixes(route, receiver)
    t = np.arange(len(late)) / 10
    state = route.state(t - 0.5)
    fast = np.linalg.norm(state.velocity, axis=1) > 5
    ahead = rotation_of_euler(state.attitude)[:, :, 0]
    delay = (distance(late.position, state.position) * ahead).sum(axis=1)[fast] / np.linalg.norm(
        state.velocity, axis=1
    )[fast]
    assert delay.std() == pytest.approx(0.05, rel=SIGMAS / np.sqrt(2 * fast.sum()))
    assert delay.mean() == pytest.approx(0, abs=SIGMAS * 0.05 / np.sqrt(fast.sum()))


def test_no_fix_is_from_the_future(route):
    delays = GnssErrors(jitter=1.0).delays(1000, 0.1, np.random.default_rng(0))
    assert delays.min() == 0
    assert len(fixes(route, Receiver(errors=GnssErrors(jitter=1.0)))) == 240


@pytest.mark.parametrize(
    "values",
    [
        {"position_sigma": (1, -1, 1)}, {"velocity_sigma": (0, 0, np.nan)}, {"position_time": 0.0}, {"velocity_time": np.inf},
        {"step_rate": -1.0}, {"step_rate": 61.0}, {"step_duration": 0.0}, {"jitter": -0.1}, {"claim": (0.0, 1.0)},
        {"claim": (1.0, np.nan)}, {"step_sigma": (1e7, 0, 0)},
    ],
)  # fmt: skip
def test_what_cannot_be_is_refused(values):
    with pytest.raises(UsageError):
        GnssErrors(**values)

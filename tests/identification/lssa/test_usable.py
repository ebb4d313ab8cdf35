import numpy as np
import pytest

from imuwb.identification.lssa import Constituents, adjust, least_squares_spectrum, usable_band

DT = 0.01


def band(time, interval=None):
    return usable_band(
        adjust(time, np.random.default_rng(1).standard_normal(time.size), Constituents(), interval=interval)
    )


def test_a_lattice_mirrors_at_its_rate_gaps_or_not():
    time = np.arange(1000) * DT
    keep = np.random.default_rng(2).random(1000) > 0.3
    for stamps in (time, time[keep]):
        found = band(stamps)
        assert (found.highest, found.mirror) == (pytest.approx(50), pytest.approx(100))
        assert found.lowest == pytest.approx(1 / (stamps[-1] - stamps[0]))


@pytest.mark.parametrize("interval", [None, DT])
def test_every_second_sample_halves_the_band(interval):
    found = band(np.arange(0, 2000, 2) * DT, interval)
    assert (found.highest, found.mirror) == (pytest.approx(25), pytest.approx(50))


def test_half_of_the_samples_missing_at_random_leave_the_lattice():
    time = np.flatnonzero(np.random.default_rng(8).random(4000) > 0.6) * DT
    adjusted = adjust(time, np.zeros(time.size) + time % 0.3, Constituents(), interval=0.0171)
    assert adjusted.interval == pytest.approx(DT)
    assert usable_band(adjusted).mirror == pytest.approx(100)


def test_an_odd_sample_here_and_there_hardly_widens_it():
    index = np.sort(np.r_[np.arange(0, 4000, 2), np.arange(101, 4000, 400)])
    time = index * DT
    found = band(time)
    assert found.mirror == pytest.approx(50, abs=0.05)
    # a line shows at the mirror nearly as high, which is what the band says
    high = least_squares_spectrum(
        adjust(
            time,
            np.cos(2 * np.pi * 7.3 * time) + 1e-3 * np.random.default_rng(3).standard_normal(time.size),
            Constituents(),
        ),
        highest=49,
    )
    at = np.abs(high.frequency - (found.mirror - 7.3)) < 0.1
    assert high.share[at].max() > 0.5


def test_random_stamps_have_no_mirror():
    time = np.sort(np.random.default_rng(4).uniform(0, 20, 2000))
    found = band(time)
    assert found.mirror is None
    assert found.highest > 200


def test_small_jitter_leaves_the_mirror_by_the_window_itself():
    time = np.arange(1500) * DT + np.random.default_rng(5).uniform(-0.1, 0.1, 1500) * DT
    found = band(time)
    fine = np.linspace(99.95, 100.05, 1001)
    window = np.abs(np.exp(2j * np.pi * np.outer(fine, time - time[0])).mean(axis=1))
    assert found.mirror == pytest.approx(fine[np.argmax(window)], abs=0.004)
    assert found.highest == pytest.approx(found.mirror / 2)


def test_long_uneven_records_are_looked_at_in_part():
    time = np.arange(100_000) * DT + np.random.default_rng(6).uniform(-0.1, 0.1, 100_000) * DT
    found = band(time)
    assert found.mirror == pytest.approx(100, abs=0.001)
    assert found.lowest == pytest.approx(1 / time[-1], rel=1e-4)


@pytest.mark.parametrize(("jitter", "mirrored"), [(0.2, True), (0.25, False)])
def test_a_mirror_shows_half_of_a_lines_power(jitter, mirrored):
    """Of uniform jitter, the window at the rate is sinc squared of twice the jitter: 0.57 and 0.41."""
    found = band(np.arange(4000) * DT + np.random.default_rng(7).uniform(-jitter, jitter, 4000) * DT)
    assert (found.mirror is not None) == mirrored

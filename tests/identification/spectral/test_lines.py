import numpy as np
import pytest

from imuwb.identification import find_lines
from imuwb.identification.spectral.lines import LONGEST_SEGMENT, _line
from imuwb.stochastic import FlickerNoise, Sinusoid, WhiteNoise

DT = 0.01


def record(*processes, n=2**15, seed=0):
    rng = np.random.default_rng(seed)
    return sum(process.sample(n, DT, rng) for process in processes)


@pytest.mark.parametrize(("n", "size"), [(2**14, 2**11), (2**15 - 1, 2**11), (2**15, 2**12), (2**20, LONGEST_SEGMENT)])
def test_resolution_is_that_of_the_spectrum_it_was_found_in(n, size):
    (line,) = find_lines(record(WhiteNoise(0.01), Sinusoid(0.2, 7.3), n=n), DT)
    assert line.resolution == pytest.approx(1 / (size * DT), rel=1e-12)
    assert abs(line.frequency - 7.3) < line.resolution


def test_two_lines_a_few_bins_apart_are_two():
    step = 1 / (2**12 * DT)
    lines = find_lines(record(WhiteNoise(0.01), Sinusoid(0.2, 7.0), Sinusoid(0.1, 7.0 + 12 * step)), DT)
    assert [line.frequency for line in lines] == pytest.approx([7.0, 7.0 + 12 * step], abs=step)
    assert lines[0].amplitude.value > lines[1].amplitude.value


def test_intervals_of_the_amplitude_contain_the_truth():
    inside, pulls = 0, []
    for seed in range(60):
        (line,) = find_lines(record(WhiteNoise(0.05), FlickerNoise(0.05), Sinusoid(0.1, 11.7), n=2**14, seed=seed), DT)
        truth = 0.1 * np.sinc(11.7 * DT)
        inside += truth in line.amplitude
        pulls.append((line.amplitude.value**2 - truth**2) / line.power_sigma)
    assert 52 <= inside <= 60
    assert 0.7 < np.std(pulls) < 1.3
    assert abs(np.mean(pulls)) < 0.5


def test_a_line_gives_back_the_sinusoid_before_it_was_averaged():
    (line,) = find_lines(record(WhiteNoise(0.001), Sinusoid(0.2, 40.0)), DT)
    process = line.process(DT)
    assert process.amplitude == pytest.approx(0.2, rel=0.01)
    assert process.frequency == line.frequency
    assert line.amplitude.value == pytest.approx(0.2 * np.sinc(0.4), rel=0.01)


def test_short_records_have_no_lines():
    assert find_lines(record(Sinusoid(1.0, 7.0), n=1000), DT) == ()


def test_the_twelve_strongest_lines_are_reported():
    sizes = {3.0 + 3 * i: 0.1 + 0.02 * i for i in range(14)}
    lines = find_lines(record(WhiteNoise(0.002), *(Sinusoid(size, f) for f, size in sizes.items())), DT)
    assert sorted(line.frequency for line in lines) == pytest.approx(sorted(sizes)[2:], abs=0.02)
    assert [line.amplitude.value for line in lines] == sorted((line.amplitude.value for line in lines), reverse=True)


def test_the_lowest_bins_hold_drift_and_no_line():
    step = 1 / (2**12 * DT)
    slow, fast = (find_lines(record(WhiteNoise(0.01), Sinusoid(0.2, k * step)), DT) for k in (1.5, 7.0))
    assert slow == ()
    assert [line.frequency for line in fast] == pytest.approx([7 * step], abs=step)


def hump(bins, center=1000, size=2**15, segment=2**12, height=8.0):
    """Return white noise whose density is raised, smoothly, over so many bins of the search."""
    f = np.fft.rfftfreq(size) * segment
    raised = 1 + (height - 1) * np.where(np.abs(f - center) < bins / 2, np.cos(np.pi * (f - center) / bins) ** 2, 0.0)
    return np.fft.irfft(np.fft.rfft(np.random.default_rng(1).standard_normal(size)) * np.sqrt(raised))


def test_the_floor_follows_what_is_wider_than_a_hundred_bins():
    assert find_lines(hump(400), DT) == ()
    assert find_lines(hump(45), DT) != ()


def test_a_lines_power_is_that_above_the_floor_in_its_bins_and_their_neighbours():
    f, floor, freedom = 0.5 * np.arange(100.0), np.full(100, 2.0), 20.0
    density = floor.copy()
    density[48:54] = 6.0, 22.0, 102.0, 82.0, 22.0, 4.0
    line = _line(f, density, floor, np.arange(49, 53), freedom, 0.95)
    excess = density[48:54] - 2.0
    assert line.amplitude.value**2 == pytest.approx(2 * excess.sum() * 0.5)
    assert line.frequency == pytest.approx((excess @ f[48:54]) / excess.sum())
    scatter = np.sqrt(
        np.sum(2.0**2 + 2 * 2.0 * excess) * 2 / freedom
    )  # of a chi-square floor, and its beat with the line
    assert line.power_sigma == pytest.approx(2 * 0.5 * scatter)
    assert line.amplitude.upper**2 == pytest.approx(line.amplitude.value**2 + 1.959964 * line.power_sigma)


def test_a_line_of_one_half_is_marked_and_one_of_both_is_not():
    values = record(WhiteNoise(0.01), Sinusoid(0.1, 7.3))
    values[2**14 :] += Sinusoid(0.1, 19.0).sample(2**14, DT, np.random.default_rng(1))
    steady, passing = sorted(find_lines(values, DT), key=lambda line: line.frequency)
    assert (round(steady.frequency, 1), steady.in_both_halves) == (7.3, True)
    assert (round(passing.frequency, 1), passing.in_both_halves) == (19.0, False)


def test_a_record_too_short_for_halves_is_not_judged():
    (line,) = find_lines(record(WhiteNoise(0.01), Sinusoid(0.1, 7.3), n=4096), DT)
    assert line.in_both_halves

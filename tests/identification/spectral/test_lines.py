import numpy as np
import pytest

from imuwb.identification import find_lines
from imuwb.identification.spectral.lines import LONGEST_SEGMENT
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

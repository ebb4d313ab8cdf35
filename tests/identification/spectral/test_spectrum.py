import numpy as np
import pytest
from scipy import signal

from imuwb.identification import find_lines, fit_spectrum, power_spectrum
from imuwb.stochastic import Autoregressive, FlickerNoise, Quantization, RandomWalk, Sinusoid, WhiteNoise

DT = 0.01


def spectrum_of(process, n=2**16, seed=0, segment=4096, **options):
    return power_spectrum(process.sample(n, DT, np.random.default_rng(seed)), DT, segment, **options)


@pytest.mark.parametrize("segment", [256, 4096, 2**20])
def test_bands_are_means_of_scipys_spectrum(segment):
    values = np.random.default_rng(0).standard_normal(20_000).cumsum()
    found = power_spectrum(values, DT, segment)
    size = min(segment, values.size)
    assert found.segment == size
    frequency, density = signal.welch(values, 1 / DT, "hann", size, detrend="linear")
    used = 0
    for f, mean, freedom in zip(found.frequency, found.density, found.degrees_of_freedom, strict=True):
        width = next(w for w in range(1, size) if abs(frequency[used + 3 : used + 3 + w].mean() - f) < 1e-9 * f)
        assert mean == pytest.approx(density[used + 3 : used + 3 + width].mean(), rel=1e-8)
        assert freedom <= 2.001 * width * (2 * values.size / size - 1)
        used += width
    assert used + 3 == size // 2
    assert found.frequency.size < 120


@pytest.mark.parametrize(
    "process", [WhiteNoise(0.3), Autoregressive((-0.6, 0.3), 1.0, DT), FlickerNoise(1.0)], ids=repr
)
@pytest.mark.parametrize("level", [0.8, 0.95])
def test_intervals_hold_the_density_as_often_as_they_say(process, level):
    inside = []
    for seed in range(60):
        found = spectrum_of(process, 2**12, seed, 512, level=level)
        far = found.frequency > 8 / (512 * DT)
        expected = 2 * process.power_spectral_density(found.frequency[far], DT)
        inside.append((found.lower[far] < expected) & (expected < found.upper[far]))
    assert np.mean(inside) == pytest.approx(level, abs=0.02)


def test_degrees_of_freedom_are_those_of_the_scatter():
    found = [spectrum_of(WhiteNoise(1.0), 2**12, seed, 1024) for seed in range(400)]
    density = np.array([one.density for one in found])
    seen = 2 * density.mean(axis=0) ** 2 / density.var(axis=0)
    ratio = seen / found[0].degrees_of_freedom
    assert np.exp(np.mean(np.log(ratio))) == pytest.approx(1, abs=0.04)
    assert (np.abs(np.log(ratio)) < 5 * np.sqrt(2 / 400)).all()


@pytest.mark.slow
@pytest.mark.parametrize(
    "truth", [{"N": 0.005, "B": 0.01}, {"Q": 2e-4, "N": 0.005, "K": 0.03}, {"N": 0.005, "B": 0.01, "K": 0.02}], ids=repr
)
def test_the_sum_is_found_within_its_intervals(truth):
    make = {"Q": Quantization, "N": WhiteNoise, "B": FlickerNoise, "K": RandomWalk}
    process = sum(make[letter](size) for letter, size in truth.items())
    inside, values = 0, []
    for seed in range(12):
        fit = fit_spectrum(spectrum_of(process, seed=seed))
        inside += sum((fit.coefficients[x].lower or 0) < size < fit.coefficients[x].upper for x, size in truth.items())
        values.append(fit.coefficients["N"].value)
        for letter in set("QNBK") - set(truth):
            assert fit.coefficients[letter].upper > 0
    assert inside >= 0.8 * 12 * len(truth)
    assert np.mean(values) == pytest.approx(0.005, rel=0.01)


def test_terms_that_are_not_there_get_a_limit():
    found = [fit_spectrum(spectrum_of(WhiteNoise(0.005), seed=seed)) for seed in range(10)]
    absent = [fit.coefficients[letter] for fit in found for letter in "QBK"]
    assert sum(c.value is None for c in absent) >= 12
    assert all(c.upper > 0 for c in absent)
    assert all((c.lower is None) == (c.value is None) for c in absent)


def test_the_fitted_density_is_one_sided():
    process = WhiteNoise(0.005) + FlickerNoise(0.01)
    found = spectrum_of(process)
    fit = fit_spectrum(found)
    f = np.geomspace(0.1, 50, 30)
    np.testing.assert_allclose(fit.density(f, DT), 2 * process.power_spectral_density(f, DT), rtol=0.1)
    assert np.median(found.density / fit.density(found.frequency, DT)) == pytest.approx(1, abs=0.05)
    assert fit.probability > 1e-3


@pytest.mark.parametrize(
    ("process", "letter", "slope"),
    [(WhiteNoise(1.0), "N", 0), (FlickerNoise(1.0), "B", -1), (RandomWalk(1.0), "K", -2), (Quantization(1.0), "Q", 2)],
    ids=repr,
)
def test_pure_noise_has_one_region_of_its_slope(process, letter, slope):
    for seed in range(3):
        values = process.sample(2**16, DT, np.random.default_rng(seed))
        regions = {region.letter: region for region in fit_spectrum(power_spectrum(values, DT, 4096)).regions}
        region = regions[letter]
        assert region.nominal == slope
        if slope == 0:
            assert region.slope.lower - 0.01 < slope < region.slope.upper + 0.01
        else:
            assert region.slope.value == pytest.approx(slope, abs=0.25)  # averages over dt bend the upper end
        assert region.end > 5 * region.start


def test_regions_meet_where_terms_are_as_strong():
    fit = fit_spectrum(spectrum_of(WhiteNoise(0.005) + RandomWalk(0.05)))
    regions = {region.letter: region for region in fit.regions}
    crossing = 0.05 / (2 * np.pi * 0.005)
    assert regions["K"].end < crossing < regions["N"].start
    assert regions["N"].start < 2 * crossing


def test_after_a_filter_the_sum_is_fitted_below_its_corner():
    values = (WhiteNoise(0.005) + FlickerNoise(0.01)).sample(2**16, DT, np.random.default_rng(1))
    fit = fit_spectrum(power_spectrum(signal.lfilter(*signal.butter(2, 12.0, fs=1 / DT), values)[1000:], DT, 4096))
    assert 1.0 < fit.highest < 12.0
    assert fit.coefficients["N"].value == pytest.approx(0.005, rel=0.05)
    assert fit_spectrum(power_spectrum(values, DT, 4096)).highest > 45


def test_bands_that_hold_a_line_are_left_out():
    quiet = (WhiteNoise(0.005) + FlickerNoise(0.01)).sample(2**16, DT, np.random.default_rng(4))
    loud = quiet + Sinusoid(0.05, 2.3).sample(2**16, DT, np.random.default_rng(5))
    lines = find_lines(loud, DT)
    plain, without, with_line = (
        fit_spectrum(power_spectrum(values, DT, 4096), taken)
        for values, taken in ((quiet, ()), (loud, ()), (loud, lines))
    )
    assert with_line.highest > 45 > without.highest
    for letter in "NB":
        assert with_line.coefficients[letter].value == pytest.approx(plain.coefficients[letter].value, rel=0.05)


def test_what_has_no_spectrum_is_refused_with_the_reason():
    with pytest.raises(ValueError, match=r"63 samples\b.*\b64\b"):
        power_spectrum(np.arange(63.0), DT)
    with pytest.raises(ValueError, match="density of 0"):
        fit_spectrum(power_spectrum(np.zeros(2**12), DT, 256))


def test_a_fit_takes_eight_bands():
    spectrum = power_spectrum(np.random.default_rng(0).standard_normal(2**12), DT, 256)
    with pytest.raises(ValueError, match="^7 bands"):
        fit_spectrum(spectrum, highest=float(spectrum.frequency[6]))
    assert fit_spectrum(spectrum, highest=float(spectrum.frequency[7])).highest == spectrum.frequency[7]

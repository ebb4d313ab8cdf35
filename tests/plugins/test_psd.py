import json
from dataclasses import replace

import numpy as np
import pytest

from imuwb.errors import MissingDataError
from imuwb.identification import fit_spectrum, power_spectrum
from imuwb.identification.spectral.lines import Line
from imuwb.review.answers.document import plain
from imuwb.statistics import Estimate
from imuwb.stochastic import RandomWalk, WhiteNoise
from imuwb_plugins import bandwidth, kaiser, psd
from imuwb_plugins.psd.compute import _line_name, _resonances, _white_to


@pytest.fixture(scope="module")
def log(make_log):
    """Return white noise; gyro_y with lines at 7, 14 and 9.3 Hz; accel_z with a random walk; accel_x low-passed."""
    n, rate = 30_000, 100.0
    rng = np.random.default_rng(31)
    t = np.arange(n) / rate
    gyro, accel = 0.01 * rng.standard_normal((n, 3)), 0.02 * rng.standard_normal((n, 3))
    for f, size in ((7.0, 0.004), (14.0, 0.002), (9.3, 0.003)):
        gyro[:, 1] += size * np.sin(2 * np.pi * f * t + f)
    accel[:, 2] += RandomWalk(0.01).sample(n, 1 / rate, rng)
    accel[:, 0] = np.convolve(0.02 * rng.standard_normal(n + 9), np.full(10, 0.1), "valid")
    return make_log(gyro, accel)


@pytest.fixture(scope="module")
def result(log):
    return psd.run([log], psd.Parameters())


def test_the_spectrum_before_averaging_is_drawn_if_wanted(log, result):
    assert all(r.raw is None for r in result.axes.values())
    raw = psd.run([log], psd.Parameters(raw=True)).axes["gyro_x"].raw
    spectrum = power_spectrum(log.imu().axes()["gyro_x"][1], 0.01)
    whole = dict(zip(spectrum.raw_frequency.tolist(), spectrum.raw.tolist(), strict=True))
    assert raw.shape[1] > 1000
    assert all(whole[f] == d for f, d in raw.T.tolist())
    assert raw[1].max() == spectrum.raw[3:].max()
    for k in (5, 40):  # a band is the mean of its densities
        inside = (spectrum.raw_frequency > spectrum.frequency[k] * 0.99) & (
            spectrum.raw_frequency < spectrum.frequency[k] * 1.01
        )
        assert spectrum.raw[inside].mean() == pytest.approx(spectrum.density[k], rel=1.5)


def test_the_density_of_white_noise_is_twice_n_squared(result):
    found = result.axes["gyro_x"]
    assert found.sides == 1
    density = found.density[found.frequency > 5]
    assert density.mean() == pytest.approx(2 * 0.01**2 / 100, rel=0.05)
    n = found.coefficients["N"]
    assert n.value == pytest.approx(0.001, rel=0.03)
    assert n.lower < 0.001 < n.upper
    assert n.unit == "rad/s/√Hz"


def test_the_area_below_the_density_is_the_variance(log, result):
    found = result.axes["gyro_z"]
    area = np.trapezoid(found.density, found.frequency)
    assert area == pytest.approx(log.imu().angular_rate.value[:, 2].var(), rel=0.05)


def test_lines_are_found_with_amplitude_and_harmonics_with_their_name(result):
    lines = {round(line.frequency, 1): line for line in result.axes["gyro_y"].lines}
    assert set(lines) == {7.0, 9.3, 14.0}
    assert [lines[f].amplitude.value for f in (7.0, 9.3, 14.0)] == pytest.approx([0.004, 0.003, 0.002], rel=0.08)
    assert lines[14.0].name == f"2 × {lines[7.0].frequency:.4g} Hz"
    assert lines[9.3].name == "line at 9.3 Hz"
    assert result.axes["gyro_y"].coefficients["N"].value == pytest.approx(0.001, rel=0.04)
    assert result.axes["gyro_x"].lines == ()


def test_a_walk_is_found_below_the_white_noise(result):
    k = result.axes["accel_z"].coefficients["K"]
    assert k.value == pytest.approx(0.01, rel=0.3)
    assert k.lower < 0.01 < k.upper
    slopes = {r.letter: r.slope.value for r in result.axes["accel_z"].regions}
    assert slopes["K"] == pytest.approx(-2, abs=0.4)


def test_a_low_pass_shows_where_white_ends(result):
    found = result.axes["accel_x"]
    assert 1 < found.white_to < 10
    assert found.excess < 1
    (finding,) = (f for f in psd.findings(result) if f.axis == "accel_x")
    assert finding.remarks[0].id == "not-white"
    assert result.axes["gyro_x"].white_to is None


@pytest.mark.slow
def test_of_a_filtered_log_what_lies_below_its_band_counts(make_log, log):
    inside = 0
    for seed in range(7):
        white = make_log(0.01 * np.random.default_rng(seed).standard_normal((15_000, 3)))
        filtered, _ = bandwidth.condition(white, bandwidth.Parameters(20.0))
        for found in psd.run([filtered], psd.Parameters()).axes.values():
            n = found.coefficients["N"]
            inside += n.lower < 0.001 < n.upper
            assert found.lines == ()
            assert found.frequency[-1] > 40  # the density is shown everywhere
    assert inside >= 18  # of 21
    cut, _ = kaiser.condition(log, kaiser.Parameters(f_pass=10.0, f_stop=12.0))
    lines = psd.run([cut], psd.Parameters()).axes["gyro_y"].lines
    assert [line.frequency for line in lines] == pytest.approx([7.0, 9.3], abs=0.01)  # 14 Hz is in the stop band


def test_findings_name_the_lines(result):
    (finding,) = (f for f in psd.findings(result) if f.axis == "gyro_y")
    assert finding.source == "psd"
    assert not finding.headline
    (text,) = (r for r in finding.remarks if r.id == "lines")
    assert "9.3 Hz" in text
    assert "2 × " in text


def test_without_lines_none_are_looked_for(log):
    assert psd.run([log], psd.Parameters(lines=False)).axes["gyro_y"].lines == ()


def test_the_segment_limits_the_lowest_frequency(log):
    gyros = replace(log, imus=(replace(log.imu(), specific_force=None),))
    found = psd.run([gyros], psd.Parameters(segment=1000))
    assert found.segment == {"gyro": 1000}
    assert found.axes["gyro_x"].frequency[0] >= 0.1


def test_of_a_log_with_gaps_the_longest_part_counts(make_log, gap):
    rng = np.random.default_rng(32)
    values = WhiteNoise(0.001).sample(6000, 0.01, rng)
    found = psd.run([make_log(values, keep=gap(6000, 1000, 2000))], psd.Parameters())
    assert any(note.startswith("gyro: 1 gap;") for note in found.notes if note.id == "gaps")
    alone = psd.run([make_log(values[2000:])], psd.Parameters())
    np.testing.assert_allclose(found.axes["gyro_x"].density, alone.axes["gyro_x"].density, rtol=1e-9)


def test_json_is_as_promised_and_has_no_nan(result):
    document = json.loads(json.dumps(plain(result), allow_nan=False))
    axis = document["axes"]["gyro_y"]
    assert {"coefficients", "frequency", "density", "sides", "lines"} <= set(axis)
    assert len(axis["frequency"]) == len(axis["density"]) == len(axis["lower"]) == len(axis["upper"])
    assert set(axis["coefficients"]) == set("QNBK")
    assert all({"frequency", "amplitude"} <= set(line) for line in axis["lines"])


def test_a_constant_axis_is_noted_and_the_others_are_analysed(make_log):
    values = np.random.default_rng(33).standard_normal((2000, 3))
    values[:, 1] = 3
    found = psd.run([make_log(values)], psd.Parameters())
    assert any(note.startswith("gyro_y: the channel is constant") for note in found.notes)
    assert found.axes["gyro_y"].density.size == 0
    assert found.axes["gyro_x"].coefficients["N"].value == pytest.approx(0.1, rel=0.1)


@pytest.mark.parametrize(
    ("values", "named"), [(np.ones(1000), "constant"), (np.arange(100.0) % 7, "100 samples; .* 256")]
)
def test_nothing_to_analyse_is_missing_data(make_log, values, named):
    with pytest.raises(MissingDataError, match=named):
        psd.run([make_log(values)], psd.Parameters())


@pytest.mark.parametrize("wrong", [{"segment": 10}, {"segment": 1 << 25}, {"level": 1.0}, {"level": float("nan")}])
def test_wrong_parameters_say_why(wrong):
    with pytest.raises(ValueError, match=r"(segment|level) is .*; it must be"):
        psd.Parameters(**wrong)


def test_all_is_drawn(result, shown):
    psd.draw(result, shown)
    assert len(shown.figures) == 2
    assert any("9.3 Hz" in cell for table in shown.tables for row in table.rows for cell in row)


@pytest.fixture(scope="module")
def white():
    """Return the spectrum of white noise, smoothed to its fitted density, and a fit of what lies below 20 Hz."""
    spectrum = power_spectrum(np.random.default_rng(34).standard_normal(20_000), 0.01)
    fit = replace(fit_spectrum(spectrum), highest=20.0)
    return replace(spectrum, density=fit.density(spectrum.frequency, 0.01)), fit


def changed(spectrum, factor, begin, end=50.0, freedom=5000.0):
    inside = (spectrum.frequency > begin) & (spectrum.frequency < end)
    return replace(
        spectrum,
        density=np.where(inside, factor * spectrum.density, spectrum.density),
        degrees_of_freedom=np.full(inside.size, freedom),
    )


@pytest.mark.parametrize(
    ("factor", "freedom", "left"), [(0.92, 5000, False), (0.88, 5000, True), (0.8, 500, False), (0.7, 500, True)]
)
def test_the_white_level_is_left_by_a_tenth_and_beyond_chance(white, factor, freedom, left):
    spectrum, fit = white
    at, excess = _white_to(changed(spectrum, factor, 30.0, freedom=freedom), fit)
    assert (at is not None) == left
    if left:
        assert at == pytest.approx(30, rel=0.08)
        assert excess == pytest.approx(factor, rel=0.01)


def test_a_broad_peak_of_twice_the_density_is_a_resonance_unless_a_line_is_there(white):
    spectrum, fit = white
    assert _resonances(changed(spectrum, 1.9, 30.0, 34.0), fit, ()) == ()
    (at,) = _resonances(changed(spectrum, 2.1, 30.0, 34.0), fit, ())
    assert 30 < at < 34
    assert _resonances(changed(spectrum, 2.1, 10.0, 14.0), fit, ()) == ()  # within the fitted band
    line = Line(32.0, Estimate(1.0, 0.9, 1.1), 0.1, 0.01)
    assert _resonances(changed(spectrum, 2.1, 30.0, 34.0), fit, [line]) == ()


@pytest.mark.parametrize(("frequency", "name"), [(14.1, "2 × 7 Hz"), (14.2, "line at 14.2 Hz"), (21.0, "3 × 7 Hz")])
def test_a_harmonic_is_a_multiple_to_a_hundredth(frequency, name):
    base, line = (Line(f, Estimate(a, a, a), 0.1, 0.01) for f, a in ((7.0, 2.0), (frequency, 1.0)))
    assert _line_name(line, (base, line)) == name
    assert _line_name(base, (base, line)) == "line at 7 Hz"

import gzip
import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import signal

from imuwb.errors import MissingDataError, UsageError
from imuwb.identification.lssa import Constituents, Noise, adjust, drifting_lines, extract, least_squares_spectrum
from imuwb.log import SECOND
from imuwb.noise_results import line_name
from imuwb.notes import ids
from imuwb.review.answers.document import plain
from imuwb_plugins import lssa
from imuwb_plugins.lssa import Parameters

N = 20_000
TIME = np.arange(N) / 100


def run(log, **options):
    return lssa.run([log], Parameters(**options))


def noise(n=N, seed=61):
    return np.random.default_rng(seed).standard_normal((n, 3))


@pytest.fixture(scope="module")
def log(make_log):
    """Return a line and its third harmonic on x, AR(1) of 0.8 on y, a random walk on z."""
    w = noise()
    coloured = np.zeros(N)
    for k in range(1, N):
        coloured[k] = 0.8 * coloured[k - 1] + w[k, 1]
    x = w[:, 0] + 0.5 * np.cos(2 * np.pi * 5 * TIME + 0.4) + 0.2 * np.cos(2 * np.pi * 15 * TIME)
    return make_log(np.stack([x, coloured, w[:, 2].cumsum()], axis=1))


@pytest.fixture(scope="module")
def result(log):
    return run(log)


def test_lines_come_with_amplitude_phase_and_name(result):
    first, third = result.axes["gyro_x"].peaks
    assert first.frequency.value == pytest.approx(5, abs=1e-3)
    assert first.amplitude.lower < 0.5 < first.amplitude.upper
    assert first.phase.lower < 0.4 < first.phase.upper
    assert third.name == "3 × 5 Hz"
    assert third.amplitude.lower < 0.2 < third.amplitude.upper
    assert all(p.significant and p.in_both_halves and p.steady for p in (first, third))
    assert result.axes["gyro_y"].peaks == result.axes["gyro_z"].peaks == ()
    (x, *others) = lssa.findings(result)
    assert x.remarks == ("lines at 5 Hz, 3 × 5 Hz",)
    assert not any(f.remarks for f in others)


def test_each_axis_has_its_structure(result):
    tenable = {axis: [h.tenable for h in found.hypotheses] for axis, found in result.axes.items()}
    assert tenable["gyro_y"] == [False, True]
    assert tenable["gyro_z"][0]
    assert [h.verdict.startswith("not ") for h in result.axes["gyro_y"].hypotheses] == [True, False]


def test_a_result_prints_one_line_for_each_axis(result):
    first, *axes = str(result).splitlines()
    assert (first, len(axes)) == ("/imu", 3)
    assert "5 Hz, amplitude 0.5" in axes[0]
    assert axes[1].endswith("no line")


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["local", "white", "ar:2", "gauss-markov", "gauss-markov:0.5", "random-walk"])
def test_json_is_as_promised_and_has_no_nan(log, kind):
    document = json.loads(json.dumps(plain(run(log, noise=kind)), allow_nan=False))
    for axis in document["axes"].values():
        for peak in axis["peaks"]:
            assert {"frequency", "amplitude", "phase", "percent", "significant"} <= set(peak)
            assert peak["amplitude"]["lower"] <= peak["amplitude"]["value"] <= peak["amplitude"]["upper"]
        critical = axis["critical_percent"]
        assert (critical is None) == (kind == "local")
        assert critical is None or 0 < critical < axis["critical_percent_record"] < 1


@pytest.mark.parametrize(
    "text", ["local", "white", "ar:2", "gauss-markov", "gauss-markov:0.5", "random-walk", "covariance:c.npy"]
)
def test_a_structure_of_the_noise_is_written_as_it_is_read(text):
    assert str(Parameters(noise=text).noise) == text


@pytest.mark.parametrize("scale", ["density", "percent", "decibels", "printed"])
def test_each_scale_is_drawn(log, shown, scale):
    found = run(log, scale=scale)
    lssa.draw(found, shown)
    assert len(shown.figures) == 3
    assert shown.tabs == ["Lssa: gyroscopes"]
    for axis in found.axes.values():
        assert np.isfinite([axis.shown, axis.shown_limit, axis.shown_record_limit]).all()
    for figure in shown.figures:
        for curve in figure.curves[:3]:  # none where there is no level: no -300 dB, no 0 on a logarithmic axis
            assert curve.y.size > 100
            assert (curve.y > (-150 if scale == "decibels" else 0)).all()
    titles = {"density": "deg/s", "percent": "%", "decibels": "eq. 12 as printed", "printed": "eq. 13 as printed"}
    assert all(titles[scale] in figure.y_title for figure in shown.figures)
    (lines,) = [t for t in shown.tables if t.title.startswith("Lines")]
    # 0.5 rad/s in the unit that is displayed
    peak = found.axes["gyro_x"].peaks[0]
    assert lines.rows[0][3].startswith(f"{np.degrees(peak.amplitude.value):.3g} [")
    assert lines.rows[0][3].endswith("deg/s")


@pytest.mark.parametrize(("frequency", "name"), [(15.1, "3 × 5 Hz"), (15.2, "15.2 Hz"), (5.02, "5.02 Hz")])
def test_a_harmonic_may_miss_its_multiple_by_a_hundredth(frequency, name):
    assert line_name(5.0, ()) == "5 Hz"
    assert line_name(frequency, (5.0,)) == name


def test_the_interval_of_a_level_includes_slow_noise(result):
    """Of AR(1) with 0.8 the level is five times, its standard error times root two, more uncertain than the samples' scatter."""
    level = result.axes["gyro_y"].constituents["constant"]
    assert 0 in level
    white = 1.96 * (1 / (1 - 0.8**2) / N) ** 0.5
    assert 2 * white < level.upper - level.value < 8 * white
    x = result.axes["gyro_x"].constituents["constant"]
    assert x.upper - x.value == pytest.approx(1.96 * (1.145 / N) ** 0.5, rel=0.5)


def test_a_forced_line_is_a_constituent_and_no_peak(log):
    found = run(log, forced="5").axes["gyro_x"]
    assert [p.name for p in found.peaks] == ["15 Hz"]
    size = found.constituents
    assert size["cosine of 5 Hz"].value == pytest.approx(0.5 * np.cos(0.4), abs=0.04)
    assert size["sine of 5 Hz"].lower < -0.5 * np.sin(0.4) < size["sine of 5 Hz"].upper


def test_jumps_are_in_the_logs_time(make_log):
    values = noise()
    values[TIME >= 50] += 4
    sizes = run(make_log(values), jumps="50").axes["gyro_z"].constituents
    assert sizes["jump at 50 s"].value == pytest.approx(4, abs=0.2)


def test_random_gaps_are_what_it_is_for(make_log):
    keep = np.random.default_rng(62).random(N) > 0.3
    found = run(make_log(noise() + 0.3 * np.cos(2 * np.pi * 5 * TIME)[:, None], keep=keep))
    for axis in found.axes.values():
        (peak,) = axis.peaks
        assert peak.frequency.value == pytest.approx(5, abs=2e-3)
        assert peak.amplitude.value == pytest.approx(0.3, abs=0.06)
        assert axis.highest == pytest.approx(50)
        assert axis.fourier_density.size == 0  # no part without gaps is long enough


@pytest.mark.slow
def test_sensors_have_their_own_clocks(make_log):
    line = np.cos(2 * np.pi * 5 * TIME)[:, None]
    found = run(make_log(noise() + line, noise(seed=63) + np.cos(2 * np.pi * 80 * TIME / 4)[:, None], accel_rate=400.0))
    assert found.axes["gyro_y"].peaks[0].frequency.value == pytest.approx(5, abs=2e-3)
    assert found.axes["accel_y"].peaks[0].frequency.value == pytest.approx(80, abs=2e-2)
    assert (found.axes["gyro_x"].highest, found.axes["accel_x"].highest) == (pytest.approx(50), pytest.approx(200))
    assert len(found.notes) == 2


def test_stamps_since_the_epoch_are_as_good(log, result):
    imu = log.imus[0]
    rate = imu.angular_rate
    late = replace(
        log, imus=(replace(imu, angular_rate=replace(rate, time=rate.time + 1_700_000_000 * SECOND)),), zero=None
    )
    for axis, found in run(late, jumps="50").axes.items():
        assert found.frequencies == result.axes[axis].frequencies
        assert [p.name for p in found.peaks] == [p.name for p in result.axes[axis].peaks]


@pytest.mark.slow
def test_beyond_the_usable_band_nothing_is_looked_for_and_it_is_said(log):
    found = run(log, highest=80.0)
    assert found.axes["gyro_x"].frequency[-1] < 50
    assert ids(found.notes) == ("band-limited",)
    assert "80 Hz" in found.notes[0]
    assert ids(run(log, highest=20.0).notes) == ("band",)


@pytest.mark.slow
def test_peaks_are_at_most_as_many_as_asked_for(log):
    assert [len(a.peaks) for a in run(log, peaks=1).axes.values()] == [1, 0, 0]
    assert not any(a.peaks for a in run(log, peaks=0).axes.values())


def test_a_constant_axis_does_not_stop_the_others(make_log):
    values = noise(2000)
    values[:, 1] = 1.0
    found = run(make_log(values))
    assert "constant" in found.axes["gyro_y"].why_none
    assert any("gyro_y" in note for note in found.notes)
    assert found.axes["gyro_x"].why_none is None


@pytest.mark.parametrize(
    ("options", "named"),
    [
        ({"forced": "0.001"}, "1000 s, but gyro has 199.99 s"),
        ({"jumps": "500"}, "jump at 500 s"),
        ({"highest": 0.001}, "0.001 Hz"),
        ({"exponentials": "1e9"}, r"transient of 1e\+09 s"),
    ],
)
def test_what_the_record_cannot_give_is_missing_data(log, options, named):
    with pytest.raises(MissingDataError, match=named):
        run(log, **options)


@pytest.mark.parametrize(("values", "named"), [(np.ones((1000, 3)), "constant"), (noise(50), "50 samples")])
def test_nothing_to_analyse_is_missing_data(make_log, values, named):
    with pytest.raises(MissingDataError, match=named):
        run(make_log(values))


def test_gaps_that_leave_third_order_noise_nothing_say_what_to_do(make_log):
    keep = np.random.default_rng(64).random(N) > 0.5
    with pytest.raises(MissingDataError, match=r"AR\(1\) or Gauss-Markov"):
        run(make_log(noise(), keep=keep), noise="ar:3")
    assert run(make_log(noise(), keep=keep), noise="ar:1").axes["gyro_x"].alpha[0] == pytest.approx(0, abs=0.05)


@pytest.mark.parametrize(
    ("array", "error", "named"),
    [
        (np.eye(5), MissingDataError, "5 samples for a series of 300"),
        (np.ones((300, 300)), MissingDataError, "covariance is"),
        (np.array(["a"]), UsageError, "numbers"),
        (np.eye(300) * 1j, UsageError, "numbers"),
        (np.array(3.0), UsageError, "square"),
        (None, UsageError, "cannot be read"),
    ],
)
def test_a_covariance_that_is_none_says_so(make_log, tmp_path, array, error, named):
    path = tmp_path / "c.npy"
    if array is not None:
        np.save(path, array)
    with pytest.raises(error, match=named):
        run(make_log(noise(300)), noise=f"covariance:{path}")


@pytest.mark.slow
def test_a_covariance_is_used(make_log, tmp_path):
    lag = np.abs(np.subtract.outer(np.arange(300), np.arange(300)))
    np.save(tmp_path / "c.npy", 0.9**lag)
    log = make_log(noise(300).cumsum(axis=0))
    given, same = (
        run(log, noise=f"covariance:{tmp_path / 'c.npy'}"),
        run(log, noise=f"gauss-markov:{-0.01 / np.log(0.9)}"),
    )
    for axis, found in given.axes.items():
        assert found.percent == pytest.approx(same.axes[axis].percent, rel=1e-5)


@pytest.mark.parametrize(
    "wrong",
    [
        {"noise": "ar:0"}, {"noise": "ar:65"}, {"noise": "ar:x"}, {"noise": "pink"}, {"noise": "gauss-markov:-1"},
        {"noise": "gauss-markov:nan"}, {"level": 2}, {"level": 0.1}, {"confidence": 1.0}, {"forced": "1,1"}, {"forced": "0"},
        {"forced": "a"}, {"jumps": "nan"}, {"exponentials": "-1"}, {"highest": 0.0}, {"highest": float("nan")}, {"oversampling": 0},
        {"peaks": 51}, {"order": 0},
    ],
)  # fmt: skip
def test_wrong_parameters_say_why(wrong):
    with pytest.raises(ValueError, match="must be|only once"):
        Parameters(**wrong)


@pytest.fixture(scope="module")
def adis(shared):
    """Return gyro x, deg/s, and accel x, g, of the real record, (n,) at 100 Hz."""
    path = shared / "static" / "adis16405_imu1.csv.gz"
    if not path.is_file():
        pytest.skip(f"{path} is not there: the recordings are not part of the repository")
    with gzip.open(path, "rt") as file:
        gyro, accel = np.loadtxt(file, delimiter=",", skiprows=1, usecols=(0, 3), unpack=True)
    return SimpleNamespace(gyro=np.ascontiguousarray(gyro), accel=np.ascontiguousarray(accel))


def lines_of(values):
    time = np.arange(values.size) / 100
    peaks = extract(least_squares_spectrum(adjust(time, values, Constituents(), Noise("local"), interval=0.01))).peaks
    return drifting_lines(values, 0.01, peaks)


@pytest.mark.slow
def test_the_real_accelerometer_has_its_line_and_harmonic(adis):
    drifting, _ = lines_of(adis.accel)
    first = drifting[0]
    assert first.frequency == pytest.approx(0.564, abs=0.002)
    assert first.amplitude.lower < 0.935e-3 < first.amplitude.upper < 1e-3
    (third,) = [x for x in drifting if abs(x.frequency - 3 * first.frequency) < 0.004]
    assert third.amplitude.lower > 0
    assert first.in_both_halves
    assert third.in_both_halves


@pytest.mark.slow
def test_no_line_of_the_real_gyro_is_claimed(adis):
    drifting, steady = lines_of(adis.gyro)
    assert not any(x.in_both_halves for x in (*drifting, *steady))


@pytest.mark.slow
def test_a_steady_line_does_not_make_the_noise_another(make_log):
    rng, n = np.random.default_rng(4), 20_000
    t = np.arange(n) / 100
    noise = signal.lfilter([1], [1, -0.5], rng.standard_normal((n, 3)), axis=0)
    gyro = noise * 1e-3
    gyro[:, 1] += 1e-3 * np.cos(2 * np.pi * 7.3 * t)
    result = lssa.run([make_log(gyro, noise * 1e-3)], lssa.Parameters())
    found = result.axes["gyro_y"]
    assert [round(peak.frequency.value, 2) for peak in found.peaks] == [7.3]
    assert found.hypotheses[1].tenable
    assert found.hypotheses[1].octaves.freedom > 5
    assert not found.hypotheses[0].tenable

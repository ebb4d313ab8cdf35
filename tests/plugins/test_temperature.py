import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lfilter

from imuwb.analysis import Case
from imuwb.errors import MissingDataError, UsageError
from imuwb.identification.temperature import Record, Stretch
from imuwb.log import SECOND, Conditioning, ImuStream, Log, Origin, Provenance, Scalars, Triad
from imuwb.notes import ids
from imuwb.review.answers.document import document
from imuwb.stochastic import ImuErrorModel, RandomWalk, WhiteNoise
from imuwb_plugins import temperature
from imuwb_plugins.temperature.axis_result import kept_constant
from imuwb_plugins.temperature.compute import _difference_of_logs
from imuwb_plugins.temperature.records import LogPart, grouped

pytestmark = pytest.mark.slow

RATE, N = 50.0, 0.005
AXES = ("gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z")


def log_at(celsius, seed, seconds=120, *, size=N, rate=RATE, name="/imu", triads=("gyro", "accel"), bias=0.0):
    """Make a still log of white noise; ``celsius`` a number, a curve through the log, or None."""
    n = round(seconds * rate)
    rng = np.random.default_rng(seed)
    time = np.rint(np.arange(n) * (SECOND / rate)).astype(np.int64)
    scale = size * rate**0.5 * np.ones(n)
    warm = None
    if celsius is not None:
        curve = np.interp(np.linspace(0, 1, n), np.linspace(0, 1, np.size(celsius)), np.atleast_1d(celsius))
        scale *= 1 + 0.004 * (curve - 25)
        bias = bias * curve
        every = slice(None, None, max(round(rate), 1))
        warm = Scalars("/temperature", time[every], curve[every])
    values = [scale[:, None] * rng.standard_normal((n, 3)) + np.reshape(bias, (-1, 1)) for _ in range(2)]
    made = {
        sensor: Triad(time, v) if sensor in triads else None
        for sensor, v in zip(("gyro", "accel"), values, strict=True)
    }
    imu = ImuStream(name, made["gyro"], made["accel"], warm, Origin())
    return Log(Provenance(f"log{seed}.csv", "csv", f"sha256:{seed}", 0), imus=(imu,))


def run(logs, **options):
    return temperature.run(logs, temperature.Parameters(**options))


@pytest.fixture(scope="module")
def chamber():
    return [log_at(t, k) for k, t in enumerate((-30.0, -10.0, 10.0, 30.0, 50.0))]


@pytest.fixture(scope="module")
def gyros():
    return [log_at(t, k, triads=("gyro",)) for k, t in enumerate((-30.0, -10.0, 10.0, 30.0, 50.0))]


@pytest.fixture(scope="module")
def result(chamber):
    return run(chamber)


def test_each_set_point_holds_the_truth_and_says_so_in_json(chamber, result):
    text, _ = document("temperature", "0", temperature.Parameters(), result, chamber, [])
    found = json.loads(text)["result"]
    assert list(found["axes"]) == list(AXES)
    inside = []
    for axis in found["axes"].values():
        assert [p["temperature"] for p in axis["by_temperature"]] == [-30, -10, 10, 30, 50]
        for p in axis["by_temperature"]:
            white = p["coefficients"]["N"]
            inside.append(white["lower"] <= N * (1 + 0.004 * (p["temperature"] - 25)) <= white["upper"])
            assert set(p["coefficients"]) == set("QNBK")
            assert p["coefficients"]["K"]["upper"] > 0
            assert abs(p["ar1"]["alpha"]) < 5 * p["ar1"]["sigma"]
        assert axis["dependence"]["p_value"] < 1e-6
        assert axis["dependence"]["depends"] is True
        assert axis["dependence"]["by_coefficient"]["alpha"]["p_value"] > 1e-5
        assert axis["dependence"]["text"]["N"].startswith("N depends")
        assert axis["reference_bias"] == pytest.approx(0, abs=0.01)
    assert sum(inside) >= 24  # of 30 at 95 %: fewer in 1 of 1e4


def test_the_model_is_a_function_of_temperature_and_reads_back(result):
    model = ImuErrorModel.from_toml(temperature.error_model(result).to_toml())
    for axis in AXES:
        for t in (-30.0, 0.0, 25.0, 50.0):
            (white, *_) = model.axes[axis].at(t).terms
            assert isinstance(white, WhiteNoise)
            assert pytest.approx(N * (1 + 0.004 * (t - 25)), rel=0.05) == white.N
        assert "K" in model.axes[axis].limits or any(
            isinstance(x, RandomWalk) for x in model.axes[axis].processes.terms
        )
    assert "log0.csv sha256:0; log1.csv" in model.provenance["log"]


def test_a_function_of_an_accelerometers_mean_says_that_gravity_is_in_it():
    warm = run([log_at(t, k, bias=9.8) for k, t in enumerate((0.0, 40.0))], function="constant")
    assert warm.axes["accel_z"].functions["bias"].formula.endswith("gravity's part of the mean")
    assert "gravity" not in warm.axes["gyro_z"].functions["bias"].formula


def test_everything_is_drawn(result, shown):
    temperature.draw(result, shown)
    assert shown.tabs == ["Allan gyro", "Allan accel", "B and K", "AR(1)", "Bias", "Functions"]
    titles = [f.title for f in shown.figures]
    assert "Gyroscopes: random walk N by temperature" in titles
    assert "accel z: Allan deviation by temperature" in titles
    (dependence,) = (t for t in shown.tables if t.title.startswith("Does"))
    assert len(dependence.rows) >= 6 * 5
    (table1,) = (t for t in shown.tables if t.title == "Gyroscopes: random walk by temperature (table 1)")
    assert [row[0] for row in table1.rows] == ["-30", "-10", "10", "30", "50"]
    assert table1.headings[1] == "N x [deg/√h]"
    assert float(table1.rows[3][1].split(" ")[0]) == pytest.approx(np.degrees(N * 1.02) * 60, rel=0.05)
    (curves,) = (f for f in shown.figures if f.title == "gyro x: Allan deviation by temperature")
    assert len([c for c in curves.curves if c.style == "curve"]) == 5
    assert "no-hysteresis" in ids(shown.notes)


def test_a_ramp_is_cut_and_its_drift_is_no_noise(shown):
    up_and_down = np.concatenate([np.linspace(-10, 10, 100), np.linspace(10, -10, 100)])
    found = run([log_at(up_and_down, 1, 800, bias=0.01)], bins=10.0)
    assert found.cut == ("bins",)
    x = found.axes["gyro_x"]
    assert [round(p.temperature) for p in x.by_temperature] == [-5, 5]
    assert [p.records for p in x.by_temperature] == [2, 2]
    assert all(p.coefficients["K"].upper < 5e-3 for p in x.by_temperature)
    assert x.dependence.by_coefficient["bias"].depends
    assert [h.temperature for h in x.hysteresis] == pytest.approx([-5, 5], abs=0.5)
    assert all(0 in h.difference for h in x.hysteresis)
    model = temperature.error_model(found).axes["gyro_x"]
    curve = np.interp([-4, 4], *zip(*model.thermal_bias, strict=True))
    np.testing.assert_allclose(curve, [-0.04, 0.04], rtol=0, atol=0.005)
    accel = temperature.error_model(found).axes["accel_x"]
    assert np.interp(5.0, *zip(*accel.thermal_bias, strict=True)) == pytest.approx(
        0, abs=0.002
    )  # 25 °C is beyond the ramp
    assert [one.removed for one in found.lags] == [False]
    assert 0 in found.lags[0].hysteresis["gyro_z"]
    temperature.draw(found, shown)
    assert sum("hysteresis" in f.title for f in shown.figures) == 2
    (lags,) = (t for t in shown.tables if t.title.startswith("Lag of"))
    assert [row[2:4] for row in lags.rows] == [("left in", axis) for axis in AXES]


def test_a_warm_up_has_bins_and_a_polynomial(shown):
    warm = 45 - 20 * np.exp(-np.linspace(0, 8, 400))
    found = run([log_at(warm, 1, 400, bias=0.01, triads=("gyro",))], bins=10.0)
    assert found.cut == ("bins",)
    x = found.axes["gyro_x"].polynomial
    assert (x.reference, round(x.highest)) == (x.lowest, 45)
    assert abs(x.factors[1].value - 0.01) < 4 * x.factors[1].sigma
    assert x.factors[1].unit == "rad/s/°C"
    temperature.draw(found, shown)
    (table,) = (t for t in shown.tables if t.title == "Gyroscopes: polynomial of the bias")
    assert table.headings[2] == "X1 [deg/s/°C]"
    assert [row[0] for row in table.rows] == ["gyro_x", "gyro_y", "gyro_z"]


def test_a_lag_that_is_removed_leaves_no_walk():
    ramp = np.concatenate([np.linspace(-10, 10, 400), np.linspace(10, -10, 400)])
    late = lfilter([0.05], [1, -0.95], ramp + 10) - 10  # of 20 s
    log = log_at(ramp, 1, 800, bias=0.01, triads=("gyro",))
    log = replace(
        log, imus=(replace(log.imus[0], temperature=Scalars("/temperature", log.imus[0].temperature.time, late)),)
    )
    removed, left = run([log], bins=10.0), run([log], bins=10.0, lag=0.0)
    assert (removed.lags[0].removed, left.lags[0].removed) == (True, False)
    assert abs(removed.lags[0].lag.value - 20) < 1
    assert "lag" in ids(removed.notes)
    model = temperature.error_model(removed).axes["gyro_x"]
    sums = [model.processes, *(one for _, one in model.thermal)]
    assert not any(isinstance(term, RandomWalk) for one in sums for term in one.terms)
    loops = [found.lags[0].hysteresis["gyro_x"] for found in (removed, left)]
    assert abs(loops[0].value) < 4 * loops[0].sigma
    assert abs(loops[1].value) > 5 * loops[1].sigma  # what the lag alone makes


def test_logs_of_one_temperature_are_taken_together(gyros):
    both = run([*gyros[:2], log_at(-10.2, 9, triads=("gyro",))])
    point = both.axes["gyro_x"].by_temperature[1]
    assert (point.records, len(both.axes["gyro_x"].by_temperature)) == (2, 2)
    assert point.temperature == pytest.approx(-10.1)
    assert both.axes["gyro_x"].turn_on is not None


def test_sensors_that_disagree_at_one_temperature_are_named(gyros):
    found = run([*gyros[:2], log_at(-10.0, 9, size=1.3 * N, triads=("gyro",))])
    assert any("at -10 °C" in note and "log1.csv, log9.csv" in note for note in found.notes)


def test_temperatures_can_be_said():
    logs = [log_at(None, k, size=N * (1 + k / 10), triads=("gyro",)) for k in range(3)]
    found = run(logs, celsius="-30,0,30")
    assert [p.temperature for p in found.axes["gyro_x"].by_temperature] == [-30, 0, 30]
    with pytest.raises(UsageError, match="2 temperatures for 3 logs"):
        run(logs, celsius="-30,0")
    with pytest.raises(MissingDataError, match=r"log0\.csv: /imu has no temperature; .*--celsius"):
        run(logs)


def test_a_function_can_be_asked_for(gyros):
    found = run(gyros, function="arrhenius")
    assert found.axes["gyro_x"].functions["N"].kind == "arrhenius"
    assert found.axes["gyro_x"].functions["bias"].kind == "constant"  # it has a sign
    with pytest.raises(UsageError, match="--function cubic: .* 4 set-points; .* 3"):
        run(gyros[:3], function="cubic")


@pytest.mark.parametrize(
    ("logs", "error", "why"),
    [
        (lambda c: c[:1], MissingDataError, "one temperature only"),
        (
            lambda c: [c[0], log_at(-30.1, 9)],
            MissingDataError,
            r"log0\.csv and 1 more: one temperature only \(-30\.\d °C\)",
        ),
        (
            lambda _: [log_at(0.0, 1), log_at(0.0, 2)],
            MissingDataError,
            "0 °C throughout, as in all logs",
        ),
        (lambda c: [c[0], c[0]], UsageError, "the same as another of the logs"),
        (lambda c: [c[0], log_at(0.0, 9, rate=25.0)], UsageError, r"gyro: 50 Hz in log0\.csv, 25 Hz in log9\.csv"),
        (lambda c: [c[0], log_at(10.0, 9, seconds=5)], MissingDataError, "one temperature only"),
    ],
)
def test_logs_that_cannot_be(gyros, logs, error, why):
    with pytest.raises(error, match=why):
        run(logs(gyros))


def test_what_must_be_said_is_said(gyros):
    zero = run([*gyros[:2], log_at(0.0, 9, triads=("gyro",))])
    assert "thermometer-zero" in ids(zero.notes)
    other = run([*gyros[:2], log_at(0.5, 9, name="/other", triads=("gyro",))])
    assert any("(/imu, /other)" in note for note in other.notes if note.id == "different-names")
    short = run([*gyros[:2], log_at(0.5, 9, seconds=5, triads=("gyro",))])
    assert any("1024 samples: 1 of 3 temperatures (0.5 °C)" in note for note in short.notes if note.id == "short")
    assert {"turn-on", "reference"} <= set(ids(short.notes))
    assert short.reference == -10
    more = run([*gyros[:2], log_at(0.5, 9), log_at(9.0, 10)])
    assert len(more.axes["gyro_x"].by_temperature) == 4
    assert len(more.axes["accel_x"].by_temperature) == 2


def test_a_ramp_has_no_plateaus():
    with pytest.raises(MissingDataError, match=r"log1\.csv: no stretch"):
        run([log_at(np.linspace(-10, 30, 50), 1, triads=("gyro",))], cut="plateaus")


@pytest.mark.parametrize(("apart", "count"), [(0.9, 1), (1.1, 2)])
def test_set_points_within_a_degree_have_one_temperature(apart, count):
    parts = [LogPart(k, None, {}, Stretch(0.0, 1.0, t, 0.0, t, None), None) for k, t in enumerate((10.0, 10.0 + apart))]
    assert len(grouped(parts, lambda part: part.stretch.nominal)) == count


@pytest.mark.parametrize(("n", "size", "noted"), [(1500, 1.05, False), (300_000, 1.016, False), (30_000, 1.08, True)])
def test_logs_whose_noise_differs_by_more_than_chance_and_two_per_cent_are_noted(n, size, noted):
    records = [Record(size**k * N * np.random.default_rng(k).standard_normal(n), 0.0, 20.0, log=k) for k in (0, 1)]
    apart = _difference_of_logs(records, 0.01, np.inf, 0.95)
    assert (apart is not None) == noted


def test_a_log_that_moves_is_refused(gyros):
    moving = log_at(10.0, 9)
    t = np.arange(6000) / RATE
    rate = moving.imu().angular_rate
    shaken = Triad(rate.time, rate.value + (np.sin(t) * (t % 7 > 2))[:, None])
    log = Log(
        moving.provenance, imus=(ImuStream("/imu", shaken, moving.imu().specific_force, moving.imu().temperature),)
    )
    with pytest.raises(MissingDataError, match=r"log9\.csv: .* moves"):
        run([*gyros[:2], log])


def test_a_study_gives_ar1_by_temperature_and_setting(gyros, shown):
    def cases():
        for log in gyros[:2]:
            for width in (2, 4):
                taps = np.ones(width) / width
                imu = log.imu()
                smooth = [
                    Triad(t.time[width - 1 :], np.stack([np.convolve(c, taps, "valid") for c in t.value.T], axis=1))
                    for t in (imu.angular_rate,)
                ]
                done = Conditioning("mean", f"{width}", causal=True, delay=0.0, band=1.0)
                changed = Log(
                    log.provenance, imus=(ImuStream("/imu", *smooth, None, imu.temperature),), conditioning=(done,)
                )
                yield Case({"log": log.provenance.path, "mean.width": str(width)}, changed)

    found = temperature.study(cases(), temperature.Parameters())
    assert [c.settings for c in found.cases] == [{"mean.width": "2"}, {"mean.width": "4"}]
    for case, expected in zip(found.cases, (-0.5, -0.75), strict=True):  # of a moving average of white noise
        assert [t for t, _ in case.axes["gyro_y"]] == [-30, -10]
        for _, first in case.axes["gyro_y"]:
            assert abs(first.alpha - expected) < 4 * first.sigma
            assert first.sigma < first.sigma_if_ar
    temperature.draw_study(found, shown)
    assert [f.title for f in shown.figures] == ["gyro y: AR(1) by setting"]
    assert shown.tables[0].headings == ("temperature [°C]", "width 2", "width 4")


@pytest.mark.parametrize(
    ("options", "why"),
    [
        ({"celsius": "a,b"}, "celsius is 'a,b'"),
        ({"celsius": "-300"}, "celsius is -300"),
        ({"bins": -1.0}, "bins is -1"),
        ({"reference": 2000.0}, "reference is 2000"),
        ({"size": 0.0}, "size is 0"),
        ({"level": 0.5}, "level is 0.5"),
    ],
)
def test_parameters_that_cannot_be(options, why):
    with pytest.raises(ValueError, match=why):
        temperature.Parameters(**options)


def test_a_shock_stands_in_the_model_and_forbids_it_if_it_is_large(gyros):
    for size, grave in ((20.0, True), (0.0, False)):
        rate = gyros[0].imus[0].angular_rate
        values = rate.value.copy()
        values[1000 : 1000 + int(2 * RATE)] += size * values.std()
        first = replace(
            gyros[0], imus=(replace(gyros[0].imus[0], angular_rate=replace(rate, value=values)),),
        )  # fmt: skip
        result = run([first, *gyros[1:]])
        assert bool(temperature.objections(result)) == grave
        assert any("shock" in doubt for doubt in temperature.error_model(result).doubts) == grave


def test_each_imu_of_the_logs_has_its_result(shown):
    one, other = (
        [log_at(t + k, int(t) + k + 50, seconds=40, name=name, triads=("gyro",)) for t in (0.0, 30.0)]
        for k, name in enumerate(("/a", "/b"))
    )
    bare = log_at(None, 20, seconds=40, name="/c", triads=("gyro",))
    found = temperature.compare_imus([*one, *other, bare], temperature.Parameters())
    assert list(found.imus) == ["/a", "/b"]
    assert list(found.left_out) == ["/c"]
    answer = temperature.answer_imus(found)
    assert [row[:2] for row in answer.rows[:4]] == [
        ("/a", "gyro x"),
        ("/a", "gyro y"),
        ("/a", "gyro z"),
        ("/b", "gyro x"),
    ]
    temperature.draw_imus(found, shown)
    assert shown.tabs == ["a", "b"]
    assert "imu-left-out" in ids(shown.notes)
    assert len({f.title for f in shown.figures}) == len(shown.figures) == 4
    with pytest.raises(MissingDataError, match="/c"):
        temperature.compare_imus([bare], temperature.Parameters())


@pytest.mark.parametrize(
    ("depends", "kind", "candidates", "kept"),
    [(True, "constant", (1,), True), (True, "linear", (1,), False), (False, "constant", (), False), (True, "constant", (), False)],
)  # fmt: skip
def test_a_dependence_that_the_model_leaves_out_is_marked(depends, kind, candidates, kept):
    own = SimpleNamespace(
        dependence=SimpleNamespace(by_coefficient={"N": SimpleNamespace(depends=depends)}),
        functions={"N": SimpleNamespace(kind=kind, candidates=candidates)},
    )
    assert kept_constant(own, "N") is kept

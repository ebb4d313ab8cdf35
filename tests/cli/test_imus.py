"""A log with several IMUs: which is analysed, and all of them compared."""

import json

import numpy as np
import pytest

from imuwb.log import SECOND, ImuStream, Log, Provenance, Scalars, Triad
from imuwb.writers import write

RATE, ROWS = 100.0, 2500
N = {"gyro": 2e-4, "accel": 2e-3}  #: rad/s/√Hz and m/s²/√Hz of the quietest IMU
TIMES = {"/a": 2.0, "/b": 1.0, "/c": 2.0}  #: noise of each IMU over that
NAMES = list(TIMES)


def triad(sensor, times, seed, rows=ROWS, turns=0.0):
    time = np.arange(rows) * round(SECOND / RATE)
    value = np.random.default_rng(seed).standard_normal((rows, 3)) * N[sensor] * times * RATE**0.5
    value[:, 2] -= 9.8 if sensor == "accel" else 0.0
    value += turns * np.sin(time / SECOND)[:, None]
    return Triad(time, value)


def imu(name, times, rows=ROWS, turns=0.0, warm=False):
    seed = sum(map(ord, name))
    parts = (triad(sensor, times, seed + i, rows, turns) for i, sensor in enumerate(N))
    celsius = Scalars(
        f"{name}/temperature", np.arange(0, rows, 50) * round(SECOND / RATE), np.linspace(0, 60, -(-rows // 50))
    )
    return ImuStream(name, *parts, celsius if warm else None)


@pytest.fixture
def log_of(tmp_path):
    """Return a function that writes a log of IMUs."""

    def make(*imus, name="log.mcap"):
        path = tmp_path / name
        write(Log(Provenance("made", "test", "", 0), imus), path)
        return path

    return make


@pytest.fixture
def three(log_of):
    return log_of(*(imu(name, times) for name, times in TIMES.items()))


def result(tmp_path):
    return json.loads((tmp_path / "x.json").read_text("utf-8"))


@pytest.mark.parametrize(
    "analysis", [("allan", "--no-estimators"), pytest.param(("noise", "--no-choose"), marks=pytest.mark.slow)]
)
def test_all_imus_are_compared_and_only_real_differences_are_claimed(three, imuwb, tmp_path, analysis):
    done = imuwb(*analysis[:1], three, *analysis[1:], "--imu", "all", "-o", "x.rrd", "--json", "x.json")
    assert done.code == 0, done.err
    told = result(tmp_path)["result"]
    assert [one["imu"] for one in told["imus"]] == NAMES
    for one in told["imus"]:
        for axis, own in one["axes"].items():
            assert own["N"]["value"] == pytest.approx(N[axis[:-2]] * TIMES[one["imu"]], rel=0.25)
    claims = {(q["axis"], q["imu"]): set(q["than"]) for q in told["quieter"] if q["coefficient"] == "N"}
    assert claims == {(axis, "/b"): {"/a", "/c"} for axis in told["imus"][0]["axes"]}
    rows = {line.split()[0]: line.split()[1:] for line in done.out.splitlines() if line.startswith("/")}
    assert list(rows) == NAMES
    assert [cell.endswith("*") for cell in rows["/b"]] == [True] * 6
    assert not any(cell.endswith("*") for name in ("/a", "/c") for cell in rows[name])
    assert float(rows["/b"][0].strip("*")) == pytest.approx(np.degrees(N["gyro"]) * 60, rel=0.25)
    assert not (tmp_path / "x.error-model.toml").exists()


def test_overlapping_intervals_claim_nothing(log_of, imuwb, tmp_path):
    log = log_of(*(imu(name, 1.0) for name in NAMES))
    imuwb("allan", log, "--no-estimators", "--imu", "all", "-o", "x.rrd", "--json", "x.json")
    claims = [q for q in result(tmp_path)["result"]["quieter"] if q["coefficient"] == "N"]
    assert claims == []
    assert any("no IMU is quieter" in note for note in result(tmp_path)["notes"])


@pytest.mark.slow
def test_a_moving_imu_is_shown_but_not_judged(log_of, imuwb, tmp_path):
    log = log_of(imu("/a", 2.0), imu("/b", 1.0), imu("/c", 9.0, turns=3.0))
    done = imuwb("allan", log, "--no-estimators", "--imu", "all", "-o", "x.rrd", "--json", "x.json")
    assert done.code == 0, done.err
    told = result(tmp_path)["result"]
    assert [one["doubted"] for one in told["imus"]] == [False, False, True]
    assert "/c" not in {name for q in told["quieter"] for name in (q["imu"], *q["than"])}
    assert {"/b"} == {q["imu"] for q in told["quieter"] if q["coefficient"] == "N"}


def test_an_imu_without_a_noise_is_left_out_with_the_reason(log_of, imuwb, tmp_path):
    log = log_of(imu("/a", 1.0), imu("/b", 1.0), imu("/c", 1.0, rows=60))
    done = imuwb("allan", log, "--no-estimators", "--imu", "all", "-o", "x.rrd", "--json", "x.json")
    assert done.code == 0, done.err
    assert [one["imu"] for one in result(tmp_path)["result"]["imus"]] == ["/a", "/b"]
    assert any(note.startswith("/c is left out") for note in result(tmp_path)["notes"])


def test_a_comparison_needs_two(log_of, imuwb):
    done = imuwb("allan", log_of(imu("/a", 1.0)), "--no-estimators", "--imu", "all", "-o", "x.rrd")
    assert (done.code, "/a" in done.err or "1 of 1" in done.err) == (3, True)


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (("psd",), "noise"), (("autoregressive",), "allan"), (("allan", "--save-model", "m.toml"), "--save-model"),
        (("noise", "--study", "bandwidth=10,20"), "--study"),
    ],
)  # fmt: skip
def test_what_cannot_use_all_imus_says_so(three, imuwb, tmp_path, arguments, named):
    done = imuwb(*arguments[:1], three, *arguments[1:], "--imu", "all", "-o", "x.rrd")
    assert (done.code, "--imu all" in done.err, named in done.err) == (2, True, True), done.err
    assert not (tmp_path / "x.rrd").exists()


def test_several_logs_are_not_compared_imu_by_imu(three, imuwb):
    done = imuwb("noise", three, three, "--imu", "all", "-o", "x.rrd")
    assert (done.code, "--imu all" in done.err) == (2, True)


@pytest.mark.parametrize("analysis", [("psd",), ("allan", "--no-estimators"), ("autocorrelation",)])
def test_without_a_choice_a_note_names_the_imu_and_the_others(three, imuwb, tmp_path, analysis):
    done = imuwb(*analysis[:1], three, *analysis[1:], "-o", "x.rrd", "--json", "x.json")
    assert done.code == 0, done.err
    (note,) = [note for note in result(tmp_path)["notes"] if "--imu" in note]
    assert all(name in note for name in NAMES)
    assert "/a is analysed" in note
    assert "/a is analysed" in " ".join(done.out.split())


def test_with_a_choice_or_a_single_imu_there_is_no_such_note(three, log_of, imuwb, tmp_path):
    for log, words in ((three, ("--imu", "/b")), (log_of(imu("/a", 1.0), name="one.mcap"), ())):
        imuwb("psd", log, *words, "-o", "x.rrd", "--json", "x.json", "--force")
        assert [note for note in result(tmp_path)["notes"] if "--imu" in note] == []


def test_health_examines_all_imus_anyway(three, imuwb, tmp_path):
    for words in ((), ("--imu", "all")):
        done = imuwb("health", three, *words, "-o", "x.rrd", "--json", "x.json", "--force")
        assert done.code == 0, done.err
        assert [stream["name"] for stream in result(tmp_path)["result"]["streams"]] == NAMES


@pytest.mark.slow
def test_conditioners_act_on_each_compared_imu(three, imuwb, tmp_path):
    words = ("--no-estimators", "--imu", "all", "--through", "decimate:factor=2", "-o", "x.rrd", "--json", "x.json")
    done = imuwb("allan", three, *words)
    assert done.code == 0, done.err
    rates = [one["rate_hz"]["gyro"] for one in result(tmp_path)["result"]["imus"]]
    assert rates == pytest.approx([RATE / 2] * 3)


def test_convert_keeps_all_imus(three, imuwb, tmp_path):
    done = imuwb("convert", three, "--imu", "all", "-o", "y.mcap")
    assert done.code == 0, done.err


def test_temperature_uses_the_imu_that_has_one_and_says_so(log_of, imuwb, tmp_path):
    log = log_of(imu("/a", 1.0), imu("/b", 1.0, rows=12000, warm=True))
    done = imuwb("temperature", log, "-o", "x.rrd", "--json", "x.json")
    assert done.code == 0, done.err
    (note,) = [note for note in result(tmp_path)["notes"] if "--imu" in note]
    assert "/b is analysed" in note
    assert result(tmp_path)["result"]["imu"] == "/b"

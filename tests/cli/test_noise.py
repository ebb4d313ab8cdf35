import json

import numpy as np
import pytest

from imuwb.log import SECOND, ImuStream, Log, Provenance, Triad
from imuwb.stochastic import Constant, ImuErrorModel, WhiteNoise
from imuwb.writers import write

N = 1e-3
RATE = 20


def written(path, seed, seconds=120, bias=0.0, times=1.0, keep=None, triad="angular_rate"):
    """Write white noise of three axes; the x axis ``times`` as large."""
    n = seconds * RATE
    rng = np.random.default_rng(seed)
    value = N * RATE**0.5 * rng.standard_normal((n, 3)) * [times, 1, 1] + bias
    time = np.arange(n) * (SECOND // RATE)
    rows = slice(None) if keep is None else keep(n)
    triads = {"angular_rate": None, "specific_force": None, triad: Triad(time[rows], value[rows])}
    write(Log(Provenance("x", "x", "", 0), imus=(ImuStream("/imu", **triads),)), path)
    return path


def finite(value):
    if isinstance(value, dict):
        return all(finite(v) for v in value.values())
    if isinstance(value, list):
        return all(finite(v) for v in value)
    return not isinstance(value, float) or np.isfinite(value)


def entities(path):
    from rerun.chunk import RrdReader

    return {str(chunk.entity_path) for chunk in RrdReader(str(path)).stream()}


@pytest.fixture
def still(tmp_path):
    return written(tmp_path / "still.csv", 1)


@pytest.mark.slow
def test_one_log_leaves_a_recording_a_model_and_json(imuwb, still, tmp_path):
    done = imuwb(
        "noise",
        still,
        "--denoise",
        3,
        "--json",
        "out.json",
        "--study",
        "bandwidth=8,4",
        "--study",
        "rate=20,10",
        "--full",
    )
    assert done.code == 0, done.err
    found = entities(tmp_path / "still.rrd")
    for tab in ("summary", "allan", "spectrum", "correlation", "autoregression", "study"):
        assert any(e.startswith(f"/{tab}/") for e in found), tab
    model = ImuErrorModel.read(tmp_path / "still.error-model.toml")
    for axis in ("gyro_x", "gyro_y", "gyro_z"):
        ((i, term),) = (x for x in enumerate(model.axes[axis].processes.terms) if isinstance(x[1], WhiteNoise))
        lower, upper = model.axes[axis].intervals[f"{i}.N"]
        assert abs(term.N / N - 1) < 0.1
        assert lower < term.N < upper
    assert "still.csv sha256:" in model.provenance["log"]
    assert model.provenance["analysis"].startswith("imuwb ")
    document = json.loads((tmp_path / "out.json").read_text("utf-8"), parse_constant=pytest.fail)
    assert finite(document)
    axis = document["result"]["axes"]["gyro_x"]
    assert axis["headline"] == "likelihood"
    for name in ("allan", "likelihood", "wavelet", "psd"):
        assert name in axis["estimators"]
    assert axis["estimators"]["likelihood"] == axis["coefficients"]
    assert axis["verdict"]
    (part,) = document["result"]["parts"]
    assert set(part) == {"allan", "psd", "autocorrelation", "autoregressive"}
    assert [c["settings"] for c in document["study"]["cases"]] == [
        {"bandwidth": b, "rate": r} for b in ("8", "4") for r in ("20", "10")
    ]
    assert "Verdicts" in done.out
    assert "Coefficients by setting" in done.out


@pytest.mark.slow
def test_a_log_long_enough_has_a_denoising_tab(imuwb, tmp_path):
    still = written(tmp_path / "still.csv", 3, seconds=210)
    assert imuwb("noise", still, "--denoise", 2, "--no-choose").code == 0
    assert any(e.startswith("/denoising/figure_0") for e in entities(tmp_path / "still.rrd"))


@pytest.mark.slow
def test_equal_logs_of_one_sensor_do_not_differ_and_give_a_turn_on_bias(imuwb, tmp_path):
    biases = (0.01, 0.03, 0.02)
    logs = [written(tmp_path / f"run{i}.csv", 10 + i, 60, bias) for i, bias in enumerate(biases)]
    done = imuwb("noise", *logs, "--no-choose", "--json", "out.json", "--full")
    assert done.code == 0, done.err
    assert "3 logs: no coefficient differs" in done.err
    found = json.loads((tmp_path / "out.json").read_text("utf-8"))["result"]["repeatability"]
    assert found["differ"] == []
    assert found["names"] == ["run0.csv", "run1.csv", "run2.csv"]
    assert "Repeatability" in done.out
    model = ImuErrorModel.read(tmp_path / "run0.error-model.toml")
    for axis in ("gyro_x", "gyro_y", "gyro_z"):
        terms = model.axes[axis].processes.terms
        (turn_on,) = (t for t in terms if isinstance(t, Constant))
        assert turn_on.sigma == pytest.approx(np.std(biases, ddof=1), rel=0.05)
        lower, upper = model.axes[axis].intervals[f"{terms.index(turn_on)}.sigma"]
        assert lower < turn_on.sigma < upper
        mean = found["coefficients"][axis]["N"]["mean"]["value"]
        assert [t.N for t in terms if isinstance(t, WhiteNoise)] == pytest.approx([mean])
        assert mean == pytest.approx(N, rel=0.05)
    shown = entities(tmp_path / "run0.rrd")
    for tab in ("summary", "allan_run0_csv", "allan_run1_csv", "allan_run2_csv"):
        assert any(e.startswith(f"/{tab}/") for e in shown)


@pytest.mark.slow
def test_logs_that_differ_are_named(imuwb, tmp_path):
    logs = [written(tmp_path / f"run{i}.csv", 20 + i, 60, times=1.5 if i else 1.0) for i in range(2)]
    done = imuwb("noise", *logs, "--no-choose", "--json", "-", "--full")
    assert json.loads(done.out)["result"]["repeatability"]["differ"] == ["gyro_x N"]
    assert "2 logs differ in gyro_x N" in done.err


@pytest.mark.slow
def test_several_logs_in_several_settings_name_the_log(imuwb, tmp_path):
    logs = [written(tmp_path / f"run{i}.csv", 30 + i, 30) for i in range(2)]
    done = imuwb("noise", *logs, "--no-choose", "--study", "bias.sensors=gyro,both", "--json", "-")
    assert done.code == 0, done.err
    settings = [c["settings"] for c in json.loads(done.out)["study"]["cases"]]
    assert [(s["log"][-8:], s["bias.sensors"]) for s in settings] == [
        ("run0.csv", "gyro"), ("run0.csv", "both"), ("run1.csv", "gyro"), ("run1.csv", "both")
    ]  # fmt: skip


@pytest.mark.slow
def test_a_gap_is_noted(imuwb, tmp_path):
    log = written(tmp_path / "gap.csv", 4, 120, keep=lambda n: np.r_[0 : n // 3, n // 2 : n])
    done = imuwb("noise", log, "--no-choose", "--denoise", 0, "--full")
    assert done.code == 0, done.err
    assert "1 gap" in done.err


@pytest.mark.parametrize("analysis", ["noise", "psd", "autocorrelation", "autoregressive", "allan"])
def test_too_short_or_constant_is_missing_data(imuwb, tmp_path, analysis):
    short = written(tmp_path / "short.csv", 5, 2)
    constant = written(tmp_path / "constant.csv", 5, 60, times=0.0)
    (tmp_path / "constant.csv.toml").unlink()  # it belongs to the table as it was
    for path, named in ((short, "40 samples"), (constant, "constant")):
        if path is constant:
            lines = path.read_text("utf-8").splitlines()
            path.write_text(
                "\n".join([lines[0], *(",".join([x.split(",")[0], "1", "2", "3"]) for x in lines[1:])]), "utf-8"
            )
        done = imuwb(analysis, path)
        assert done.code == 3, (path, done.err)
        assert named in done.err
        assert not path.with_suffix(".rrd").exists()


@pytest.mark.slow
def test_one_constant_axis_is_noted_and_the_others_are_analysed(imuwb, tmp_path):
    log = written(tmp_path / "stuck.csv", 6, 60, times=0.0)
    done = imuwb("noise", log, "--no-choose", "--denoise", 0, "--json", "-")
    assert done.code == 0, done.err
    document = json.loads(done.out, parse_constant=pytest.fail)
    assert any("SUSPICIOUS: the channel is constant" in v for v in document["result"]["axes"]["gyro_x"]["verdict"])
    model = ImuErrorModel.read(tmp_path / "stuck.error-model.toml")
    assert set(model.axes) == {"gyro_y", "gyro_z"}


@pytest.mark.parametrize("wrong", [["--level", "1"], ["--denoise", "21"], ["--denoise", "-1"], ["--level", "0.1"]])
def test_wrong_parameters_say_why(imuwb, still, wrong):
    done = imuwb("noise", still, *wrong)
    assert (done.code, "must be" in done.err) == (2, True)


def test_the_model_is_not_written_over(imuwb, still, tmp_path):
    (tmp_path / "still.error-model.toml").write_text("mine", "utf-8")
    done = imuwb("noise", still)
    assert (done.code, "--force" in done.err) == (2, True)
    assert (tmp_path / "still.error-model.toml").read_text("utf-8") == "mine"
    assert not (tmp_path / "still.rrd").exists()

"""The command, and logs that lack something."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from imuwb.errors import MissingDataError, UsageError
from imuwb.review.answers.document import plain
from imuwb.stochastic import AxisModel, GaussMarkov, ImuErrorModel, Sinusoid, Sum
from imuwb_plugins import outage
from imuwb_plugins.outage import Parameters

from .made import KNOWN, Shown, sensor, stated

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[3]


def test_no_error_model(log):
    with pytest.raises(UsageError, match=r"--error-model MODEL.toml"):
        outage.run([log], Parameters())


def test_a_reference_that_the_log_has_not(log, toml):
    with pytest.raises(MissingDataError, match="no receiver of the log has RTK-fixed"):
        outage.run([log], stated(error_model=toml, models="none", at="150:10", reference="fixed"))


def test_an_odometer_that_the_log_has_not(log, toml):
    with pytest.raises(MissingDataError, match="--speed"):
        outage.run([log], stated(error_model=toml, models="none", at="150:10", speed=0.1))


def test_nothing_scored_is_said(log, toml):
    truth = log.references[0]
    short = replace(truth, **{n: getattr(truth, n)[:900] for n in ("time", "position", "velocity", "attitude")})
    with pytest.raises(MissingDataError, match="truth"):
        outage.run([replace(log, references=(short,))], stated(error_model=toml, models="none", at="150:10"))


def test_a_filter_that_cannot_run_is_a_row_with_its_reason(log, tmp_path):
    axes = {
        name: AxisModel(Sum((*own.processes.terms, *(GaussMarkov(1e-6, t) for t in (5.0, 50.0, 500.0, 900.0)))))
        for name, own in sensor().axes.items()
    }
    wide = tmp_path / "wide.toml"
    wide.write_text(ImuErrorModel("wide", axes).to_toml(), "utf-8")
    result = outage.run([log], stated(error_model=wide, models="none,full", at="150:10"))
    assert [f.name for f in result.filters] == ["none"]
    assert "states" in result.failed["full"]
    assert plain(result)["failed"] == result.failed
    assert [note.id for note in result.notes].count("failed") == 1
    shown = Shown()
    outage.draw(result, shown)
    drift = next(t for t in shown.tables if t.title.startswith("Drift"))
    filters = next(t for t in shown.tables if t.title.startswith("Filters"))
    assert [row[0] for row in drift.rows] == [row[0] for row in filters.rows] == ["none", "full"]
    assert result.failed["full"] in filters.rows[1]


def test_lines_without_room_are_noted_and_the_filter_runs(log, tmp_path):
    model = sensor(flicker=True)
    accel = model.axes["accel_x"]
    lines = [Sinusoid(0.01 + k / 1000, 0.05 + k / 10) for k in range(20)]
    axes = {**model.axes, "accel_x": replace(accel, processes=Sum((*accel.processes.terms, *lines)))}
    path = tmp_path / "lines.toml"
    path.write_text(ImuErrorModel("lines", axes).to_toml(), "utf-8")
    result = outage.run([log], stated(error_model=path, models="full", at="150:10"))
    assert not result.failed
    (note,) = [note for note in result.notes if note.id == "lines-left-out"]
    assert "accel_x at" in note
    (own,) = result.filters
    assert len(own.states) <= 48
    assert any(state.startswith("accel_x: sinusoid") for state in own.states)
    assert "20 x sinusoid" in own.accelerometers


def test_the_doubts_of_the_error_model_are_repeated(log, tmp_path):
    path = tmp_path / "doubted.toml"
    path.write_text(replace(sensor(), doubts=("the IMU moved", "one axis is stuck")).to_toml(), "utf-8")
    result = outage.run([log], stated(error_model=path, models="none,15AV", at="150:10"))
    told = [note for note in result.notes if note.id == "model-doubt"]
    assert len(told) == 2
    assert "the IMU moved" in told[0]
    assert "one axis is stuck" in told[1]
    assert all("the IMU moved" in f.document for f in result.filters)


def test_too_short_to_tune(log, toml):
    with pytest.raises(MissingDataError, match=r"tuning needs 4 outages of 30 s"):
        outage.run([log], stated(error_model=toml, models="none", tune=True))


@pytest.mark.slow
def test_samples_that_know_what_comes_are_not_causal(command, mcap, toml):
    options = ("--error-model", toml, "--models", "none", "--at", "150:10", "-o", "o.rrd", "--json", "o.json", *KNOWN)
    code, _, err = command("outage", mcap, *options, "--through", "wavelet:levels=6")
    assert code == 0, err
    (one,) = json.loads(Path("o.json").read_text("utf-8"))["result"]["outages"]
    assert one["models"]["none"]["causal"] is False


@pytest.mark.slow
def test_a_recording_and_json_are_written(command, mcap, toml):
    code, out, err = command(
        "outage", mcap, "--error-model", toml, "--models", "none,full", "--durations", "10", "--random", "25",
        "-o", "o.rrd", "--json", "o.json",
    )  # fmt: skip
    assert code == 0, err
    assert "10 s without GNSS" in out
    assert Path("o.rrd").stat().st_size > 100_000
    content = json.loads(Path("o.json").read_text("utf-8"), parse_constant=pytest.fail)
    assert content["analysis"] == "outage"
    assert content["result"]["summary"][0]["models"]["full"]["count"] == 25
    assert content["params"]["durations"] == [10.0]
    code, _, err = command("outage", mcap, "--error-model", toml, "--models", "none", "--at", "150:10", "-o", "o.rrd")
    assert code == 2
    assert "o.rrd exists" in err


def test_json_on_stdout_is_all_there_is(command, mcap, toml):
    code, out, _ = command(
        "outage",
        mcap,
        "--error-model",
        toml,
        "--models",
        "none",
        "--at",
        "150:10",
        "-o",
        "o.rrd",
        "--json",
        "-",
        *KNOWN,
    )
    assert code == 0
    assert json.loads(out)["result"]["outages"][0]["start"] == pytest.approx(150.0)


def test_seconds_count_from_the_logs_start_in_a_cut(command, mcap, toml):
    options = (
        "--error-model",
        toml,
        "--models",
        "none",
        "--at",
        "190:10",
        "--settling",
        "20",
        "--force",
        "-o",
        "o.rrd",
        "--json",
    )
    code, _, err = command("outage", mcap, *KNOWN, *options, "cut.json", "--start", "80", "--end", "230")
    assert code == 0, err
    (one,) = json.loads(Path("cut.json").read_text("utf-8"))["result"]["outages"]
    assert one["start"] == pytest.approx(190.0)


@pytest.mark.parametrize(
    ("options", "code", "words"),
    [
        (("--at", "20:10"), 2, "before the filter has settled"),
        (("--at", "235:10"), 2, "ends after the log"),
        (("--durations", "600"), 3, "--settling"),
        (("--models", "x"), 2, "models is 'x'"),
        (("--receiver", "x"), 2, "no receiver 'x'"),
        (("--error-model", "not.toml"), 2, "not.toml"),
    ],
)
def test_exit_codes(command, mcap, toml, options, code, words):
    model = () if "--error-model" in options else ("--error-model", toml)
    found, _, err = command("outage", mcap, *model, *KNOWN, *options, "-o", "o.rrd")
    assert (found, words in err) == (code, True), err
    assert "Traceback" not in err
    assert not Path("o.rrd").exists()


def test_a_still_log_is_no_drive(command, toml):
    code, _, err = command("outage", ROOT / "samples" / "static.mcap", "--error-model", toml, "-o", "o.rrd")
    assert code == 3
    assert "--gnss" in err

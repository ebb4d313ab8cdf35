"""Health as a plugin: on the command line, as JSON, and drawn."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from imuwb.log import SECOND, GnssStream
from imuwb.notes import ids
from imuwb.review.answers.document import plain
from imuwb_plugins import health

SAMPLE = Path(__file__).resolve().parents[2] / "samples" / "static.mcap"


@pytest.fixture
def damaged(make_log, gap):
    """Return a log with a gap, and a gyro that is not connected."""
    rng = np.random.default_rng(3)
    gyro = 0.01 * rng.standard_normal((6000, 3)) * [1, 0, 1]
    return make_log(gyro, 0.02 * rng.standard_normal((6000, 3)) - [0, 0, 9.8], keep=gap(6000, 2000, 2030))


def test_the_command_shows_the_verdict_and_leaves_a_recording(command, tmp_path):
    code, out, err = command("health", SAMPLE, "-o", "health.rrd", "--full")
    out += err
    assert code == 0, err
    for text in ("good", "25 °C for 60 min", "/imu/data is still for"):
        assert text in " ".join(out.split())
    assert (tmp_path / "health.rrd").read_bytes()[:3] == b"RRF"
    assert (tmp_path / "health.rrd").stat().st_size > 10_000


def test_the_document_on_stdout_holds_streams_faults_and_segments(command):
    code, out, _ = command("health", SAMPLE, "-o", "health.rrd", "--json", "-")
    document = json.loads(out)
    assert (code, document["analysis"], document["params"]) == (0, "health", {"lines": True})
    result = document["result"]
    assert set(result) == {"streams", "faults", "segments", "segments_of", "still", "moving", "even"}
    stream, thermometer = result["streams"]
    assert (stream["name"], stream["verdict"]) == ("/imu/data", "good")
    assert (thermometer["name"], thermometer["verdict"]) == ("/imu/data thermometer", "good")
    assert len(stream["rate"]) == len(stream["time"]) == 400
    assert np.mean(stream["rate"]) == pytest.approx(20, rel=1e-3)
    (fault,) = result["faults"]
    assert set(fault) == {"stream", "kind", "what", "severity", "count", "start", "length", "consequence"}
    assert (fault["severity"], fault["start"]) == ("note", None)
    assert [s["moving"] for s in result["segments"]] == [False]


def test_lines_are_left_away_when_asked(make_log):
    rng = np.random.default_rng(4)
    gyro = 0.01 * rng.standard_normal((6000, 3)) + 0.01 * np.sin(np.arange(6000) * 0.5)[:, None]
    log = make_log(gyro)
    assert any(f.kind == "line" for f in health.run([log], health.Parameters()).faults)
    assert health.run([log], health.Parameters(lines=False)).faults == ()


def test_verdicts_and_faults_are_drawn_the_worst_first(damaged, shown):
    result = health.run([damaged], health.Parameters())
    health.draw(result, shown)
    verdict, found = shown.tables
    assert verdict.rows == (("/imu", result.streams[0].verdict, "2"),)
    assert [row[:2] for row in found.rows] == [("/imu gyro_y", "fault"), ("/imu", "warning")]
    assert found.rows[0][4:7] == ("5 970", "—", "—")
    assert found.rows[1][2] == "gaps"
    assert "0.3 s missing" in found.rows[1][3]
    assert found.rows[1][5] == "19.99 s"
    rates, motion = shown.figures
    assert [curve.label for curve in rates.curves] == ["/imu"]
    assert [mark.x for mark in rates.marks] == [pytest.approx(19.99)]
    assert set(motion.curves[0].y) == {0.0}
    assert ids(shown.notes) == ("motion",)
    assert "0 s" in shown.notes[0]


def test_a_clean_log_says_that_nothing_was_found(make_log, shown):
    health.draw(
        health.run([make_log(np.random.default_rng(5).standard_normal((3000, 3)) * 0.01)], health.Parameters()), shown
    )
    assert shown.tables[1].rows[0][:4] == ("all", "—", "—", "nothing")
    assert shown.figures[0].marks == ()


def test_json_has_no_nan(damaged):
    text = json.dumps(plain(health.run([damaged], health.Parameters())), allow_nan=False)
    assert json.loads(text)["faults"][0]["kind"] == "constant"


def test_even_motion_is_in_the_answer(make_log):
    rng = np.random.default_rng(5)
    log = make_log(0.01 * rng.standard_normal((6000, 3)), 0.02 * rng.standard_normal((6000, 3)) - [0, 0, 9.8])
    time = np.arange(61) * SECOND
    gnss = GnssStream("fix", time, np.tile([0.8, 0.2, 0.0], (61, 1)), np.tile([20.0, 0.0, 0.0], (61, 1)))
    result = health.run([replace(log, gnss=(gnss,))], health.Parameters())
    assert "moves evenly" in health.answer(result).sentences[-1]
    assert "even motion" not in health.answer(health.run([log], health.Parameters())).about

import json
import os
import time

import numpy as np
import pytest

import imuwb as package
from imuwb import read
from imuwb.cli import demo

PLUGIN = '''
"""Spread of an axis."""
from dataclasses import dataclass
from typing import Annotated, Literal
import numpy as np
from imuwb.analysis import Curve, Figure, Table

@dataclass(frozen=True)
class Parameters:
    axis: Annotated[Literal["x", "y", "z"], "which one"] = "z"
    times: Annotated[int, "factor, positive"] = 1

    def __post_init__(self):
        if self.times < 1:
            raise ValueError(f"times is {self.times}; it must be positive")

def run(logs, parameters):
    values = logs[0].imus[0].specific_force.value[:, "xyz".index(parameters.axis)]
    return {"spread": float(values.std()) * parameters.times, "none": float("nan")}

def draw(result, review):
    x = np.array([1.0, 10.0])
    review.figure(Figure("Spread", "x [1]", "spread [m/s²]", (Curve("s", x, x * result["spread"], (76, 120, 168)),)))
    review.table(Table("Spread", ("spread",), ((f"{result['spread']:.3g} m/s²",),)))
    review.note("a note of the plugin")
'''


def test_help_lists_all_commands_and_is_quick(imuwb):
    done = imuwb("--help")
    assert done.code == 0
    for name in ("info", "allan", "simulate", "view", "plugins", "demo"):
        assert name in done.out


def test_help_imports_nothing_heavy():
    import subprocess
    import sys

    code = (
        "import sys; from imuwb.cli.app import build; build(['--help']);"
        "print([m for m in ('numpy', 'rerun', 'scipy', 'pyarrow', 'numba') if m in sys.modules])"
    )
    assert (
        subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip() == "[]"
    )


def test_version(imuwb):
    assert imuwb("--version").out.strip() == package.__version__


def test_completion_is_offered(imuwb):
    assert "imuwb" in imuwb("--show-completion", "bash", _TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION="1").out


@pytest.mark.slow
def test_allan_leaves_a_recording_json_and_a_model(imuwb, static_mcap, tmp_path):
    done = imuwb(
        "allan", static_mcap, "--json", "out.json", "--save-model", "model.toml", "--averaging-times", "log:20"
    )
    assert done.code == 0
    assert "deg/√h" in done.out
    assert (tmp_path / "static.rrd").stat().st_size > 10_000
    document = json.loads((tmp_path / "out.json").read_text("utf-8"))
    assert set(document) == {
        "run",
        "imuwb",
        "schema",
        "analysis",
        "level",
        "logs",
        "params",
        "notes",
        "answer",
        "result",
    }
    assert (document["analysis"], document["schema"], document["level"]) == ("allan", 1, 0.95)
    assert document["logs"][0]["hash"].startswith("sha256:")
    assert list(document["result"]["axes"]) == ["gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z"]
    axis = document["result"]["axes"]["gyro_x"]
    assert len(axis["averaging_time"]) == len(axis["allan_deviation"]) == len(axis["lower"]) == len(axis["upper"])
    for letter in "QNBKR":
        c = axis["coefficients"][letter]
        assert set(c) == {"value", "lower", "upper", "unit", "at"}
        assert c["upper"] > 0
        assert c["value"] is None or c["lower"] < c["value"] < c["upper"]
    assert axis["coefficients"]["N"]["unit"] == "rad/s/√Hz"
    model = package.ImuErrorModel.read(tmp_path / "model.toml")
    assert model.axes["gyro_x"].intervals["0.N"] == pytest.approx(
        (axis["coefficients"]["N"]["lower"], axis["coefficients"]["N"]["upper"])
    )
    assert not [name for name in os.listdir(tmp_path) if "partial" in name]


@pytest.mark.slow
def test_json_on_stdout_is_json_alone(imuwb, static_mcap):
    done = imuwb("allan", static_mcap, "--json", "-")
    assert json.loads(done.out)["result"]["imu"] == "/imu/data"
    assert "deg/√h" in done.err


@pytest.mark.slow
def test_existing_files_are_kept_without_force(imuwb, static_mcap, tmp_path):
    (tmp_path / "static.rrd").write_bytes(b"mine")
    done = imuwb("allan", static_mcap)
    assert done.code == 2
    assert "--force" in done.err
    assert (tmp_path / "static.rrd").read_bytes() == b"mine"
    assert imuwb("allan", static_mcap, "--force").code == 0
    assert (tmp_path / "static.rrd").stat().st_size > 10_000


@pytest.mark.slow
def test_a_part_of_a_log(imuwb, static_mcap):
    done = imuwb("allan", static_mcap, "--start", "10", "--end", "2024-01-01T00:00:50", "--json", "-")
    assert json.loads(done.out)["result"]["duration"] == pytest.approx(40, abs=0.05)


def test_info_shows_the_streams(imuwb, static_mcap):
    done = imuwb("info", static_mcap, "--json")
    document = json.loads(done.out)
    assert set(document) == {"path", "format", "hash", "streams", "notes", "truth"}
    imu = document["streams"][0]
    assert (imu["name"], imu["kind"], imu["count"], imu["epoch"]) == ("/imu/data", "imu", 3000, "unix")
    assert imu["rate_hz"] == pytest.approx(50)
    assert imu["end_ns"] - imu["start_ns"] == pytest.approx(59.98e9)
    assert (imu["gaps"], imu["repairs"]) == ([], [])
    assert "FLU" in imu["frame"]
    assert "/imu/data" in imu["name"] in imuwb("info", static_mcap).out


@pytest.mark.parametrize("suffix", [".mcap", ".csv"])
def test_simulate_writes_what_it_simulates(imuwb, tmp_path, static_log, suffix):
    arguments = ["--preset", "3dm-gx3-25", "--hours", 1 / 60, "--rate", 50, "--seed", 1]
    assert imuwb("simulate", "static", *arguments, "-o", f"s{suffix}").code == 0
    found, truth = read(tmp_path / f"s{suffix}").imus[0], static_log.imus[0]
    for name in ("angular_rate", "specific_force", "temperature"):
        assert np.array_equal(getattr(found, name).time, getattr(truth, name).time)
        assert np.array_equal(getattr(found, name).value, getattr(truth, name).value)
    assert imuwb("simulate", "static", *arguments, "-o", f"s{suffix}").code == 2


def test_a_single_file_is_a_plugin(imuwb, static_mcap, tmp_path):
    (tmp_path / "spread.py").write_text(PLUGIN, "utf-8")
    done = imuwb("./spread.py", static_mcap, "--axis", "x", "--times", "2", "--json", "out.json")
    assert done.code == 0, done.err
    document = json.loads((tmp_path / "out.json").read_text("utf-8"))
    assert document["analysis"] == "spread"
    assert document["params"] == {"axis": "x", "times": 2}
    assert document["result"]["none"] is None
    assert "a note of the plugin" in document["notes"]
    assert "m/s²" in done.out
    assert "which one" in imuwb("./spread.py", "--help").out.lower()


def test_plugin_parameters_are_checked_with_their_reason(imuwb, static_mcap, tmp_path):
    (tmp_path / "spread.py").write_text(PLUGIN, "utf-8")
    done = imuwb("./spread.py", static_mcap, "--times", "0")
    assert (done.code, "must be positive" in done.err) == (2, True)
    assert imuwb("./spread.py", static_mcap, "--axis", "w").code == 2
    assert not (tmp_path / "static.rrd").exists()


def test_plugins_are_listed(imuwb):
    done = imuwb("plugins")
    for name in ("allan", "mcap", "csv", "rtklib", "imuwb_plugins.allan"):
        assert name in done.out


@pytest.mark.slow
def test_the_demo_answers_briefly_and_leaves_recordings_and_pages(imuwb, tmp_path, monkeypatch):
    """The demo runs over a part of each sample log."""
    (tmp_path / "short").mkdir()
    for name, end in (("static", "300"), ("drive", "300")):
        done = imuwb("convert", demo.samples() / f"{name}.mcap", "--end", end, "-o", f"short/{name}.mcap")
        assert done.code == 0, done.err
    monkeypatch.setattr(demo, "samples", lambda: tmp_path / "short")
    done = imuwb("demo")
    assert done.code == 0, done.err
    assert len((done.out + done.err).splitlines()) <= 40
    assert any(line.split()[:3] == ["Next", "imuwb", "outage"] for line in (done.out + done.err).splitlines())
    for name in ("imuwb-demo", "imuwb-demo-drive"):
        assert (tmp_path / f"{name}.rrd").stat().st_size > 50_000
        assert (tmp_path / f"{name}.html").stat().st_size > 50_000


def test_no_colour_is_honoured(imuwb, static_mcap):
    assert "\x1b[" not in imuwb("info", static_mcap, NO_COLOR="1", FORCE_COLOR="").out


def test_progress_is_for_terminals_only(imuwb, static_mcap):
    assert "reading" not in imuwb("info", static_mcap).err


def test_view_refuses_what_is_no_recording(imuwb, static_mcap):
    done = imuwb("view", static_mcap)
    assert (done.code, "not a Rerun recording" in done.err) == (4, True)
    assert imuwb("view", "gone.rrd").code == 4


@pytest.mark.slow
def test_live_without_a_viewer_fails_clearly(imuwb, static_mcap, tmp_path):
    start = time.monotonic()
    done = imuwb("allan", static_mcap, "--live")
    assert done.code == 1
    assert "viewer" in done.err
    assert time.monotonic() - start < 60
    assert not (tmp_path / "static.rrd").exists()


def test_outputs_may_not_be_each_other_or_the_log(imuwb, static_mcap):
    for arguments in (
        ["--json", "same", "--save-model", "same"],
        ["--json", static_mcap, "--force"],
    ):
        done = imuwb("allan", static_mcap, *arguments)
        assert (done.code, "a different name" in done.err) == (2, True)


def test_a_plugin_that_fails_is_named_with_its_line(imuwb, static_mcap, tmp_path):
    (tmp_path / "bad.py").write_text(PLUGIN.replace("    x = np.array", "    1 / 0\n    x = np.array"), "utf-8")
    done = imuwb("./bad.py", static_mcap)
    assert done.code == 1
    assert "bad.py, line" in done.err
    assert "ZeroDivisionError" in done.err
    assert not (tmp_path / "static.rrd").exists()


@pytest.mark.slow
def test_a_pipe_without_unicode_does_not_matter(tmp_path, static_mcap):
    import subprocess
    import sys

    command = [sys.executable, "-m", "imuwb", "allan", str(static_mcap), "-o", str(tmp_path / "x.rrd")]
    done = subprocess.run(command, capture_output=True, check=False, env={**os.environ, "PYTHONIOENCODING": "cp1252"})
    assert done.returncode == 0
    assert "√" in done.stdout.decode("utf-8")


@pytest.mark.slow
def test_processes_are_named_in_json(imuwb, static_mcap):
    axis = json.loads(imuwb("allan", static_mcap, "--json", "-").out)["result"]["axes"]["gyro_x"]
    assert axis["processes"]["terms"][0]["process"] == "white_noise"


@pytest.mark.slow
def test_a_moving_record_is_noted_first(imuwb, shared):
    done = imuwb("allan", shared / "mcap" / "husky_test1_ros2cdr_zstd.mcap", "-o", "husky.rrd", "--json", "-")
    assert done.code == 0
    document = json.loads(done.out)
    assert document["result"]["moving"]
    assert all(option in document["notes"][0] for option in ("--start 236", "--end 247"))
    assert "overflow" not in done.err

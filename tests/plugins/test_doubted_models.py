"""No error model of a record that does not suit it, unless forced; the model then states the doubts, and so do those that use it."""

import json
from pathlib import Path

import numpy as np
import pytest

from imuwb.stochastic import ImuErrorModel

pytestmark = pytest.mark.slow

N, RATE = 6000, 100.0


def write(name, moved=False, seed=0):
    rng = np.random.default_rng(seed)
    t = np.arange(N) / RATE
    rows = np.hstack([t[:, None], rng.standard_normal((N, 3)) * 2e-3, rng.standard_normal((N, 3)) * 1e-2 - [0, 0, 9.8]])
    if moved:
        rows[2000:2600, 2] += np.sin(np.arange(600) / 30)
    header = "time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2"
    np.savetxt(name, rows, "%.9g", ",", header=header, comments="")


COMMANDS = [
    ("noise", "--no-choose", "--denoise", "0"),
    ("allan", "--no-estimators", "--save-model", "moved.error-model.toml"),
    ("autoregressive", "--save-model", "moved.error-model.toml"),
]


@pytest.mark.parametrize("arguments", COMMANDS, ids=[c[0] for c in COMMANDS])
def test_a_record_that_is_not_still_leaves_no_model_unless_forced(command, arguments):
    name, *options = arguments
    write("moved.csv", moved=True)
    code, _, err = command(name, "moved.csv", *options, "-o", "moved.rrd", "--json", "moved.json")
    assert code == 3
    assert "moved.error-model.toml is not written" in err
    assert "--force-model" in err
    assert "--start 26 --end 59" in err
    assert not Path("moved.error-model.toml").exists()
    assert Path("moved.rrd").stat().st_size > 1000
    assert json.loads(Path("moved.json").read_text("utf-8"))["result"]
    code, _, err = command(name, "moved.csv", *options, "-o", "moved.rrd", "--force", "--force-model")
    assert code == 0, err
    doubts = ImuErrorModel.read("moved.error-model.toml").doubts
    assert any("movement" in doubt for doubt in doubts)
    code, out, _ = command("model", "show", "moved.error-model.toml")
    assert code == 0
    assert doubts[0].partition(",")[0] in out
    code, out, _ = command("model", "export", "moved.error-model.toml", "--to", "json")
    assert json.loads(out)["doubts"] == list(doubts)


def test_the_quiet_part_leaves_a_model_and_an_older_one_stays(command):
    write("moved.csv", moved=True)
    options = ("--no-choose", "--denoise", "0", "-o", "moved.rrd", "--force")
    code, _, err = command("noise", "moved.csv", *options, "--start", "26", "--end", "59")
    assert code == 0, err
    before = Path("moved.error-model.toml").read_text("utf-8")
    assert not ImuErrorModel.read("moved.error-model.toml").doubts
    code, _, err = command("noise", "moved.csv", *options)
    assert code == 3
    assert "left as it was" in err
    assert Path("moved.error-model.toml").read_text("utf-8") == before


def test_without_a_model_to_save_nothing_is_refused(command):
    write("moved.csv", moved=True)
    code, _, err = command("allan", "moved.csv", "--no-estimators", "-o", "moved.rrd")
    assert code == 0, err


def test_of_several_logs_the_one_that_moved_is_named(command):
    write("still.csv", seed=1)
    write("moved.csv", moved=True)
    options = ("--no-choose", "-o", "both.rrd")
    code, _, err = command("noise", "still.csv", "moved.csv", *options)
    assert code == 3
    assert "moved.csv: 1 shock or movement" in err
    assert "raises the mean square" in " ".join(err.split())
    code, _, err = command("noise", "still.csv", "moved.csv", *options, "--force", "--force-model")
    assert code == 0, err
    doubts = ImuErrorModel.read("both.error-model.toml").doubts
    assert any(doubt.startswith("moved.csv: ") for doubt in doubts)
    assert not any(doubt.startswith("still.csv: ") for doubt in doubts)


def test_commands_without_objections_have_no_such_option(command):
    for arguments in (("psd", "--help"), ("outage", "--help"), ("calibration", "six-position", "--help")):
        code, out, _ = command(*arguments)
        assert code == 0
        assert "--force-model" not in out
    assert "--force-model" in command("temperature", "--help")[1]

"""``imuwb simulate drive`` as one types it."""

import sys

import numpy as np
import pytest

from imuwb.cli import main
from imuwb.readers import read
from imuwb.simulation import Odometer, Receiver, drive, mixed_route, preset


@pytest.fixture
def simulate(monkeypatch, tmp_path, capsys):
    def run(*arguments):
        monkeypatch.chdir(tmp_path)
        monkeypatch.setattr(sys, "argv", ["imuwb", "simulate", "drive", *map(str, arguments)])
        try:
            main()
        except SystemExit as leaving:
            return leaving.code or 0, *capsys.readouterr()
        return 0, *capsys.readouterr()

    return run


def test_a_preset_prints_its_outages_as_an_option(simulate, tmp_path):
    model = tmp_path / "m.toml"
    model.write_text(preset("mpu-6050").to_toml(), "utf-8")
    code, out, err = simulate("--preset", "turin-1", "--error-model", model, "--seed", 1, "--rate", 20, "-o", "d.mcap")
    assert (code, out) == (0, "--at 200:30,310:30,430:60,590:30,720:30,850:30\n")
    assert "wrote d.mcap" in err
    log = read(tmp_path / "d.mcap")
    assert (len(log.imus), len(log.gnss), len(log.references), len(log.speeds)) == (1, 1, 1, 0)


def test_options_reach_the_simulation(simulate, tmp_path):
    code, out, _ = simulate(
        "--duration", 90, "--sensor", "mpu-6050", "--seed", 3, "--route-seed", 4, "--rate", 80, "--gnss-rate", 5,
        "--position-sigma", "1,2,3", "--velocity-sigma", "0.1,0.2,0.3", "--latency", 0.1, "--lever-arm", "1,0,-1",
        "--odometer", "--odometer-scale", 0.01, "--odometer-step", 0.5, "--vibration", 0.2, "--quantize",
        "--truth-rate", 20, "-o", "d.csv",
    )  # fmt: skip
    assert (code, out) == (0, "")
    expected = drive(
        preset("mpu-6050"), mixed_route(90, 4), 3, rate=80, vibration=0.2, quantize=True, truth_rate=20,
        receiver=Receiver(5, (1, 2, 3), (0.1, 0.2, 0.3), 0.1, (1, 0, -1)), odometer=Odometer(10, 0.01, 0.5),
    )  # fmt: skip
    found = [read(tmp_path / name) for name in ("d.csv", "d.gnss.csv", "d.speed.csv", "d.reference.csv")]
    assert np.array_equal(found[0].imus[0].specific_force.value, expected.imus[0].specific_force.value)
    assert np.array_equal(found[1].gnss[0].position, expected.gnss[0].position)
    assert np.array_equal(found[2].speeds[0].value, expected.speeds[0].value)
    assert np.array_equal(found[3].references[0].attitude, expected.references[0].attitude)


@pytest.mark.parametrize(
    ("arguments", "why"),
    [
        (["--preset", "rome", "--sensor", "mpu-6050"], "turin-1, turin-2"),
        (["--sensor", "mpu-6050"], "either --preset"),
        (["--preset", "turin-1", "--duration", 100, "--sensor", "mpu-6050"], "either --preset"),
        (["--preset", "turin-1"], "--error-model"),
        (["--duration", 100, "--sensor", "mpu-6050", "--lever-arm", "1,2"], "three numbers"),
        (["--duration", 100, "--sensor", "mpu-6050", "--odometer-step", 1], "give --odometer"),
        (["--duration", 100, "--sensor", "mpu-6050", "--gnss-rate", 0], "above 0"),
    ],
)
def test_wrong_usage_is_explained(simulate, tmp_path, arguments, why):
    code, _, err = simulate(*arguments, "-o", "d.mcap")
    assert code == 2
    assert why in err
    assert not (tmp_path / "d.mcap").exists()


def test_no_table_beside_is_written_over(simulate, tmp_path):
    (tmp_path / "d.gnss.csv").write_text("mine", "utf-8")
    code, _, err = simulate("--duration", 90, "--sensor", "mpu-6050", "-o", "d.csv")
    assert (code, "d.gnss.csv exists" in err) == (2, True)
    assert (tmp_path / "d.gnss.csv").read_text("utf-8") == "mine"
    assert not (tmp_path / "d.csv").exists()

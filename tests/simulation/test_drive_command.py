"""``imuwb simulate drive`` as one types it."""

import sys

import numpy as np
import pytest

from imuwb.cli import main
from imuwb.readers import read
from imuwb.simulation import GnssErrors, MotionNoise, Odometer, Receiver, Road, drive, mixed_route, preset


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
    assert "Wrote  d.mcap" in err
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


def same(found, expected):
    for triad in ("angular_rate", "specific_force"):
        assert np.array_equal(getattr(found.imus[0], triad).value, getattr(expected.imus[0], triad).value)
    for name in ("position", "velocity", "position_sigma", "velocity_sigma"):
        assert getattr(found.gnss[0], name) == pytest.approx(getattr(expected.gnss[0], name), rel=1e-14, abs=1e-15)
    assert np.array_equal(found.references[0].attitude, expected.references[0].attitude)
    assert found.truth == expected.truth != {}


def test_a_road_noise_in_motion_and_errors_of_fixes_reach_the_simulation(simulate, tmp_path):
    arguments = ["--duration", 90, "--sensor", "stim300", "--seed", 3, "--route-seed", 4, "--rate", 50, "-o", "d.mcap"]
    code, _, _ = simulate(
        *arguments, "--road", "B", "--motion-noise", "1e-3,2e-2,3e-5,4e-4", "--noise-acts", "always", "--gnss-errors",
        "sigma=1,tau=30,velocity_sigma=0.1,velocity_tau=4,steps=2,step_sigma=7,step_time=5,jitter=0.01,claim=3,velocity_claim=2",
    )  # fmt: skip
    assert code == 0
    errors = GnssErrors((1, 1, 2), 30, (0.1, 0.1, 0.1), 4, 2, (7, 7, 14), 5, 0.01, (3, 2))
    noise = MotionNoise((1e-3, 2e-2), (3e-5, 4e-4), "always")
    expected = drive(
        preset("stim300"),
        mixed_route(90, 4),
        3,
        rate=50,
        road=Road("B", 4),
        motion_noise=noise,
        receiver=Receiver(errors=errors),
    )
    same(read(tmp_path / "d.mcap"), expected)


def test_two_values_of_noise_and_one_key_of_errors_are_enough(simulate, tmp_path):
    arguments = ["--duration", 90, "--sensor", "mpu-6050", "--rate", 50, "-o", "d.mcap"]
    assert simulate(*arguments, "--motion-noise", "1e-3,2e-2", "--gnss-errors", "claim=2")[0] == 0
    receiver = Receiver(errors=GnssErrors(claim=(2, 2)))
    noise = MotionNoise((1e-3, 2e-2))
    expected = drive(preset("mpu-6050"), mixed_route(90), 0, rate=50, motion_noise=noise, receiver=receiver)
    same(read(tmp_path / "d.mcap"), expected)


ONE = ["--duration", 100, "--sensor", "mpu-6050"]


@pytest.mark.parametrize(
    ("arguments", "why"),
    [
        ([*ONE, "--road", "F"], "'F' is not one of"),
        ([*ONE, "--road", "C", "--rate", 20], "on a rough road"),
        ([*ONE, "--motion-noise", "1e-3"], "N_G,N_A,K_G,K_A"),
        ([*ONE, "--motion-noise", "1,2,3"], "N_G,N_A,K_G,K_A"),
        ([*ONE, "--motion-noise", "a,b"], "1e-3,1e-2"),
        ([*ONE, "--motion-noise=-1e-3,1e-2"], "--motion-noise: "),
        ([*ONE, "--motion-noise", "nan,1"], "--motion-noise"),
        ([*ONE, "--noise-acts", "always"], "--motion-noise"),
        ([*ONE, "--noise-acts", "never"], "'moving', 'always'"),
        ([*ONE, "--gnss-errors", "2"], "key=value"),
        ([*ONE, "--gnss-errors", "sigma=x"], "sigma=2"),
        ([*ONE, "--gnss-errors", "sigma=-1"], "0 or more"),
        ([*ONE, "--gnss-errors", "sigm=1"], "sigma, tau"),
        ([*ONE, "--gnss-errors", "latency=1"], "--latency"),
        ([*ONE, "--gnss-errors", "tau=10"], "sigma"),
        ([*ONE, "--gnss-errors", "sigma=1,tau=0"], "above 0"),
        ([*ONE, "--gnss-errors", "step_sigma=1"], "steps"),
        ([*ONE, "--gnss-errors", "steps=100"], "0 to 60"),
        ([*ONE, "--gnss-errors", "claim=0"], "above 0"),
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

"""The true parameters of a simulated drive: in its log, in its files, and in what ``imuwb info`` prints."""

import json
import sys

import pytest

from imuwb.cli import main
from imuwb.joining import joined
from imuwb.notes import ids
from imuwb.readers import describe, read
from imuwb.simulation import GnssErrors, MotionNoise, Receiver, Road, drive, mixed_route, preset
from imuwb.writers import write

ERRORS = GnssErrors((1.0, 1.0, 2.0), 30.0, step_rate=1.5, jitter=0.02, claim=(3.0, 1.0))


@pytest.fixture(scope="module")
def log():
    return drive(
        preset("mpu-6050"), mixed_route(90), 1, rate=50, road=Road("B", seed=7), receiver=Receiver(latency=0.1, errors=ERRORS),
        motion_noise=MotionNoise((1e-3, 2e-2), (3e-5, 4e-4), "always"),
    )  # fmt: skip


def test_a_log_states_what_was_put_in(log):
    truth = dict(log.truth)
    assert {name: truth.pop(name).split()[0] for name in ("road.vibration.gyro.N", "road.vibration.accel.N")}
    assert truth == {
        "road.Gd(n0)": "6.4e-05 m³",
        "road.seed": "7",
        "motion_noise.gyro.N": "0.001 rad/s/√Hz",
        "motion_noise.accel.N": "0.02 m/s²/√Hz",
        "motion_noise.gyro.K": "3e-05 rad/s/√s",
        "motion_noise.accel.K": "0.0004 m/s²/√s",
        "motion_noise.when": "always",
        "gnss.position.white.sigma": "2 2 3.5 m",
        "gnss.velocity.white.sigma": "0.1 0.1 0.15 m/s",
        "gnss.latency": "0.1 s",
        "gnss.position.gauss_markov.sigma": "1 1 2 m",
        "gnss.position.gauss_markov.Tc": "30 s",
        "gnss.steps.rate": "1.5 1/min",
        "gnss.steps.sigma": "5 5 10 m",
        "gnss.steps.duration": "10 s",
        "gnss.jitter": "0.02 s",
        "gnss.position.claim": "3",
        "gnss.velocity.claim": "1",
    }


def test_a_plain_drive_and_a_plain_file_state_nothing(tmp_path):
    plain = drive(preset("mpu-6050"), mixed_route(90), 1, rate=50)
    assert plain.truth == {}
    for name in ("a.mcap", "a.csv"):
        write(plain, tmp_path / name)
        found = read(tmp_path / name)
        assert found.truth == {}
        assert "simulated" not in ids(found.notes)
    assert "simulated" not in (tmp_path / "a.csv.toml").read_text("utf-8")


@pytest.mark.parametrize("name", ["a.mcap", "a.csv"])
def test_files_keep_the_truth(log, tmp_path, name):
    write(log, tmp_path / name)
    found = read(tmp_path / name)
    assert found.truth == log.truth
    assert "simulated" in ids(found.notes)


def test_an_index_and_a_joined_table_state_it(log, tmp_path):
    write(log, tmp_path / "a.mcap")
    summary = describe(tmp_path / "a.mcap")
    assert summary is not None
    assert summary.truth == log.truth
    plain = drive(preset("mpu-6050"), mixed_route(90), 1, rate=50)
    assert joined(plain, log).truth == log.truth


def test_info_shows_the_truth(log, tmp_path, monkeypatch, capsys):
    write(log, tmp_path / "a.mcap")
    monkeypatch.setattr(sys, "argv", ["imuwb", "info", str(tmp_path / "a.mcap"), "--json"])
    with pytest.raises(SystemExit) as leaving:
        main()
    assert not leaving.value.code
    assert json.loads(capsys.readouterr().out)["truth"] == log.truth

"""A climate chamber, and its command as one types it."""

import sys

import numpy as np
import pytest

from imuwb.cli import main
from imuwb.errors import UsageError
from imuwb.readers import read
from imuwb.simulation import Temperature, chamber, preset, set_points, static
from imuwb.simulation.chamber import names


@pytest.fixture
def simulate(monkeypatch, tmp_path, capsys):
    def run(*arguments):
        monkeypatch.chdir(tmp_path)
        monkeypatch.setattr(sys, "argv", ["imuwb", "simulate", *map(str, arguments)])
        try:
            main()
        except SystemExit as leaving:
            return leaving.code or 0, *capsys.readouterr()
        return 0, *capsys.readouterr()

    return run


def gyro(log):
    return log.imus[0].angular_rate.value


def test_set_points_go_from_the_first_to_the_last():
    assert set_points(-30, 60, 10) == (-30, -20, -10, 0, 10, 20, 30, 40, 50, 60)
    assert set_points(60, 20, -25) == (60, 35)
    assert set_points(0, 0.3, 0.1) == (0, 0.1, 0.2, 0.3)
    assert set_points(25, 25, 10) == (25,)


@pytest.mark.parametrize(
    ("first", "last", "step", "why"),
    [
        (-30, 60, 0, "must lead"),
        (-30, 60, -10, "must lead"),
        (-30, 60, float("nan"), "must lead"),
        (-30, 60, 0.1, "901 set-points"),
        (0, 0.01, 1e-4, "0.001"),
        (-300, 60, 10, "-273.15"),
        (0, float("inf"), 10, "-273.15"),
    ],
)
def test_set_points_that_cannot_be_are_refused(first, last, step, why):
    with pytest.raises(UsageError, match=why):
        set_points(first, last, step)


def test_names_sort_as_the_logs_were_recorded():
    found = names(set_points(-30, 60, 10))
    assert found[:5] == ("01_minus-30C", "02_minus-20C", "03_minus-10C", "04_0C", "05_plus-10C")
    assert sorted(found) == list(found)
    assert names((2.5, -2.5)) == ("1_plus-2.5C", "2_minus-2.5C")


def test_each_set_point_has_its_own_noise_whichever_others_there_are():
    model = preset("ahrs300cc")
    cold, mild, warm = chamber(model, (-30.0, 0.0, 30.0), 100, 50, 7)
    (again,) = chamber(model, (0.0,), 100, 50, 7)
    assert np.array_equal(gyro(mild), gyro(again))
    (other,) = chamber(model, (0.0,), 100, 50, 8)
    assert not np.array_equal(gyro(mild), gyro(other))
    for log, celsius, wanted in ((cold, -30.0, 3.0994), (mild, 0.0, 2.6285), (warm, 30.0, 2.8262)):
        assert set(log.imus[0].temperature.value) == {celsius}
        sigma = np.radians(wanted / 60) * np.sqrt(50)
        assert gyro(log).std() == pytest.approx(sigma, rel=0.03)
    pairs = np.corrcoef([gyro(log)[:, 0] for log in (cold, mild, warm)])
    assert np.abs(pairs - np.eye(3)).max() < 0.06


def test_a_chamber_is_a_folder_of_logs(simulate, tmp_path):
    small = ("--preset", "motionpakii", "--hours", 0.002, "--from", -10, "--to", 10, "--rate", 50, "--seed", 4)
    code, out, err = simulate("chamber", *small, "-o", "c")
    assert (code, out) == (0, "")
    assert "Wrote  c" in err
    files = sorted((tmp_path / "c").iterdir())
    assert [file.name for file in files] == ["1_minus-10C.mcap", "2_0C.mcap", "3_plus-10C.mcap"]
    wanted = list(chamber(preset("motionpakii"), (-10.0, 0.0, 10.0), 7.2, 50, 4))
    for file, log in zip(files, wanted, strict=True):
        found = read(file).imus[0]
        assert np.array_equal(found.angular_rate.value, gyro(log))
        assert np.array_equal(found.temperature.value, log.imus[0].temperature.value)
    code, _, err = simulate("chamber", *small, "-o", "c")
    assert (code, "--force" in err) == (2, True)
    code, _, err = simulate("chamber", *small, "--step", 20, "-o", "c", "--force")
    assert (code, "2 other files" in err) == (0, True)


def test_an_empty_folder_is_a_place(simulate, tmp_path):
    (tmp_path / "c").mkdir()
    code, _, err = simulate("chamber", "--preset", "mpu-6050", "--hours", 0.001, "--to", -30, "-o", "c")
    assert (code, "temperature" in err) == (0, True)


@pytest.mark.parametrize(
    ("arguments", "code", "why"),
    [
        (["--preset", "rome"], 2, "motionpakii"),
        ([], 2, "--preset NAME"),
        (["--preset", "motionpakii", "--hours", 0], 2, "--hours is 0"),
        (["--preset", "motionpakii", "--step", 0], 2, "must lead"),
        (["--preset", "motionpakii", "--quantize"], 2, "lsb"),
    ],
)
def test_wrong_usage_is_explained_and_leaves_no_folder(simulate, tmp_path, arguments, code, why):
    found, _, err = simulate("chamber", *arguments, "-o", "c")
    assert (found, why in err) == (code, True)
    assert not (tmp_path / "c").exists()


@pytest.mark.parametrize(("place", "code", "why"), [("c.mcap", 2, "folder"), ("no/c", 1, "no"), ("file", 2, "exists")])
def test_a_place_that_cannot_be_is_refused(simulate, tmp_path, place, code, why):
    (tmp_path / "file").write_text("mine", "utf-8")
    found, _, err = simulate("chamber", "--preset", "motionpakii", "-o", place)
    assert (found, why in err) == (code, True)
    assert (tmp_path / "file").read_text("utf-8") == "mine"


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("-30", -30.0),
        ("-40:70", Temperature.ramp(-40.0, 70.0, 36.0)),
        ("0:-30,20:-30,30:10", Temperature(((0.0, -30.0), (20.0, -30.0), (30.0, 10.0)))),
    ],
)
def test_a_temperature_is_written_in_three_ways(simulate, tmp_path, text, wanted):
    code, *_ = simulate(
        "static", "--preset", "motionpakii", "--hours", 0.01, "--rate", 20, "--temperature", text, "-o", "s.mcap"
    )
    assert code == 0
    expected = static(preset("motionpakii"), 36, 20, 0, celsius=wanted)
    found = read(tmp_path / "s.mcap").imus[0]
    assert np.array_equal(found.angular_rate.value, gyro(expected))
    assert found.temperature.value == pytest.approx(expected.imus[0].temperature.value)


def test_a_drive_warms_up_over_its_whole_length(simulate, tmp_path):
    code, *_ = simulate(
        "drive", "--duration", 90, "--sensor", "mpu-6050", "--rate", 20, "--temperature", "-10:80", "-o", "d.mcap"
    )
    assert code == 0
    assert read(tmp_path / "d.mcap").imus[0].temperature.value == pytest.approx(-10.0 + np.arange(90))


@pytest.mark.parametrize("text", ["warm", "1:2:3", "1,2", "0:1,0:2", "-300", "-40:5000", "", ":", "nan", "0:1,2"])
def test_a_temperature_that_cannot_be_read_is_refused(simulate, tmp_path, text):
    code, _, err = simulate("static", "--preset", "motionpakii", "--hours", 0.01, "--temperature", text, "-o", "s.mcap")
    assert (code, "temperature" in err) == (2, True)
    assert not (tmp_path / "s.mcap").exists()

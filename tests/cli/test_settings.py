"""Settings files: --config and --save-config."""

import tomllib
from types import SimpleNamespace

import pytest

from imuwb.cli.settings import settings_text

SIMULATE = ("simulate", "static", "--preset", "mpu-6050", "--hours", "0.002", "--rate", "20.25", "--seed", "7")


def test_a_run_is_repeated_exactly(imuwb, tmp_path):
    assert imuwb(*SIMULATE, "-o", "first.mcap", "--save-config", "run.toml").code == 0
    saved = tomllib.loads((tmp_path / "run.toml").read_text("utf-8"))
    assert saved == {
        "command": "simulate static", "preset": "mpu-6050", "hours": 0.002, "rate": 20.25, "seed": 7,
        "output": "first.mcap", "quantize": False,
    }  # fmt: skip
    again = imuwb("simulate", "static", "--config", "run.toml", "-o", "second.mcap", "--save-config", "again.toml")
    assert again.code == 0, again.err
    assert (tmp_path / "second.mcap").read_bytes() == (tmp_path / "first.mcap").read_bytes()
    assert tomllib.loads((tmp_path / "again.toml").read_text("utf-8")) == saved | {"output": "second.mcap"}


def test_the_command_line_beats_the_file(imuwb, csv_log, rows, tmp_path):
    log = csv_log(rows(60))
    (tmp_path / "run.toml").write_text(f"log = {str(log)!r}\nrate = 50\neven = true\nfull = true\n", "utf-8")
    assert "50 Hz" in imuwb("info", "--config", "run.toml").out
    beaten = imuwb("info", "--config", "run.toml", "--rate", "25", "--no-even").out
    assert "25 Hz" in beaten
    assert "Streams" in beaten  # of the file
    assert imuwb("info", "gone.csv", "--config", "run.toml").code == 4


def test_lists_and_tables_are_texts_of_the_command_line(imuwb, tmp_path):
    (tmp_path / "run.toml").write_text(
        'preset = "mpu-6050"\nhours = 0.001\noutput = "warm.mcap"\ntemperature = [[0, 20], [2, 30]]\n', "utf-8"
    )
    assert imuwb("simulate", "static", "--config", "run.toml").code == 0
    (tmp_path / "many.toml").write_text('logs = ["gone.csv"]\nunits = {gyro = "deg/s", accel = "g"}\n', "utf-8")
    assert "gone.csv" in imuwb("allan", "--config", "many.toml").err


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("rat = 5", ["'rat'", "did you mean rate?"]),
        ("rate = true", ["rate is True", "a number"]),
        ("rate = 'fast'", ["rate is 'fast'", "number"]),
        ("rate = -1", ["rate is -1", "or more"]),
        ("even = 1", ["even is 1", "true or false"]),
        ("even = ", ["not TOML", "line 1"]),
        ("command = 'noise'", ["imuwb noise", "this is imuwb info"]),
        ("config = 'b.toml'", ["'config'"]),
        ("log = [true]", ["log is [True]"]),
    ],
)
def test_an_error_names_file_key_and_what_is_expected(imuwb, tmp_path, text, named):
    (tmp_path / "run.toml").write_text(text + "\n", "utf-8")
    done = imuwb("info", *(() if text.startswith("log") else ("x.csv",)), "--config", "run.toml")
    assert (done.code, done.out) == (2, "")
    assert all(part in done.err for part in ("run.toml", *named)), done.err


def test_a_missing_file_and_one_that_exists_are_wrong_usage(imuwb, static_mcap, tmp_path):
    done = imuwb("info", static_mcap, "--config", "none.toml")
    assert (done.code, "none.toml" in done.err) == (2, True)
    (tmp_path / "old.toml").write_text("old", "utf-8")
    done = imuwb("info", static_mcap, "--save-config", "old.toml")
    assert (done.code, done.out, (tmp_path / "old.toml").read_text("utf-8")) == (2, "", "old")
    assert imuwb(*SIMULATE, "-o", "a.mcap", "--save-config", "a.mcap").code == 2


def test_no_secret_of_an_address_is_saved():
    text = settings_text(
        "info", "1", {"log": "https://me:word@host/a.csv?sig=x", "join": ["s3://b/c?k=1"]}, {"log": True, "join": True}
    )
    assert not any(secret in text for secret in ("word", "sig=", "k=1")), SimpleNamespace(text=text)

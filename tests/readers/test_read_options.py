"""The options of reading: values, texts, and what is refused."""

import math
import subprocess
import sys

import pytest

from imuwb.errors import UsageError
from imuwb.options import options_of
from imuwb.readers import ReadOptions


def test_texts_become_values():
    options = ReadOptions(rate="200", columns="time, gx,-", units="gyro=deg/s, accel=g", frame="FLU", epoch="boot")
    assert options == ReadOptions(
        rate=200.0, columns=("time", "gx", "-"), units={"gyro": "deg/s", "accel": "g"}, frame="FLU", epoch="boot"
    )


def test_each_option_has_a_help_text_and_a_name_that_scripts_use():
    options = options_of(ReadOptions)
    assert [option.name for option in options] == [
        "time_source", "rate", "even", "columns", "units", "frame", "epoch", "messages", "memory",
    ]  # fmt: skip
    assert all(option.help for option in options)


@pytest.mark.parametrize("rate", [1e-6, 1e8])
def test_the_slowest_and_the_fastest_rate(rate):
    assert ReadOptions(rate=rate).rate == rate


@pytest.mark.parametrize("rate", [math.nan, math.inf, 0, 0.0, -1.0, 0.99e-6, 1.01e8])
def test_another_rate_is_refused(rate):
    with pytest.raises(UsageError, match=r"rate is .*1e-06.*1e\+08"):
        ReadOptions(rate=rate)


@pytest.mark.parametrize(
    ("name", "value", "rule"),
    [
        ("frame", "XYZ", "FRD or FLU"),
        ("frame", "frd", "FRD or FLU"),
        ("frame", "", "FRD or FLU"),
        ("epoch", "gps", "unix or boot or log"),
        ("rate", "fast", "a number"),
        ("units", "gyro", "gyro=deg/s"),
    ],
)
def test_another_text_is_refused_with_the_rule(name, value, rule):
    with pytest.raises(UsageError, match=rf"{name} is '{value}'.*{rule}"):
        ReadOptions(**{name: value})


def test_unknown_units_are_refused():
    with pytest.raises(UsageError, match="'foo'"):
        ReadOptions(units="gyro=foo")


def test_options_that_a_format_does_not_use_are_named():
    assert ReadOptions(rate=5.0, frame="FLU").unused(("frame",)) == ("rate",)


def test_a_command_line_declares_the_options_without_numpy():
    code = "import sys, imuwb.readers; imuwb.readers.ReadOptions(); assert 'numpy' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)

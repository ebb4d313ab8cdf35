"""Completion: the program is called as the scripts of the shells call it."""

import subprocess
import sys

import pytest

from imuwb.cli.completion import words_before


def bash(line):
    words = line.split(" ")
    return {"COMP_WORDS": line, "COMP_CWORD": str(len(words) - 1), "_IMUWB_COMPLETE": "complete_bash"}


def zsh(line):
    return {"_TYPER_COMPLETE_ARGS": line, "_IMUWB_COMPLETE": "complete_zsh"}


def fish(line):
    return {
        "_TYPER_COMPLETE_ARGS": line,
        "_TYPER_COMPLETE_FISH_ACTION": "get-args",
        "_IMUWB_COMPLETE": "complete_fish",
    }


@pytest.mark.parametrize("shell", [bash, zsh, fish])
@pytest.mark.parametrize(
    ("line", "offered", "absent"),
    [
        ("imuwb noise --le", ["--level"], ["--lever-arm", "--start"]),
        ("imuwb allan log.mcap --av", ["--averaging-times"], ["--level"]),
        ("imuwb ", ["info", "noise", "simulate", "demo"], ["static"]),
        ("imuwb au", ["autocorrelation", "autoregressive"], ["allan"]),
        ("imuwb model ", ["show", "compare", "export", "check"], ["info"]),
        ("imuwb simulate static --ho", ["--hours"], ["--preset"]),
    ],
)
def test_a_shell_is_offered_what_fits(imuwb, shell, line, offered, absent):
    shown = imuwb(**shell(line)).out
    assert all(word in shown for word in offered), shown
    assert not any(word in shown for word in absent), shown


@pytest.mark.parametrize(
    ("line", "offered", "absent"),
    [
        ("imuwb model export --to k", ["kalibr", "kf-gins"], ["ros"]),
        ("imuwb outage log.mcap --models 15AV,", ["15AV,full", "15AV,motion"], ["15AV,15AV"]),
        ("imuwb noise log.mcap --through wav", ["wavelet", "levels="], ["kaiser"]),
        ("imuwb simulate drive --preset t", ["turin-1", "turin-2"], []),
        ("imuwb simulate static --preset m", ["mpu-6050"], ["stim300"]),
        ("imuwb lssa log.mcap --trend ", ["constant", "quadratic"], ["--trend"]),
        ("imuwb outage log.mcap --mounting ", ["auto"], []),
        ("imuwb noise static.mcap --imu ", ["all", "/imu/data"], ["temperature"]),
        ("imuwb noise gone.mcap --imu ", ["all"], ["/imu/data"]),
        ("imuwb noise log.csv --imu ", ["imu"], []),
    ],
)
def test_a_shell_is_offered_values(imuwb, static_mcap, csv_log, rows, line, offered, absent):
    csv_log(rows(20))
    shown = imuwb(**fish(line)).out
    assert all(word in shown for word in offered), shown
    assert not any(word in shown for word in absent), shown


@pytest.mark.slow
def test_what_is_offered_imports_neither_scipy_nor_the_viewer(static_mcap):
    for line in ("imuwb noise static.mcap --imu ", "imuwb outage x --models ", "imuwb noise x --through "):
        words = {"_IMUWB_COMPLETE": "complete_zsh", "_TYPER_COMPLETE_ARGS": line}
        code = (
            f"import os, sys; os.environ.update({words!r}); import imuwb.cli\n"
            "try: imuwb.cli.main()\nfinally: print({'scipy', 'rerun', 'numba', 'matplotlib'} & set(sys.modules))"
        )
        done = subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, check=False, cwd=static_mcap.parent
        )
        assert done.stdout.rstrip().endswith("set()"), done.stdout + done.stderr


@pytest.mark.parametrize(
    ("environment", "words"),
    [
        (bash("imuwb noise --le"), ["noise"]),
        (bash("imuwb noise"), []),
        ({"COMP_WORDS": "imuwb no log.mcap", "COMP_CWORD": "1"}, []),  # the cursor stands inside the line
        (zsh("imuwb noise "), ["noise"]),
        (zsh("imuwb noise"), []),
        (zsh("imuwb"), []),
    ],
)
def test_the_word_at_the_cursor_is_left_out(environment, words):
    assert words_before(environment) == words

"""Completion: the program is called as the scripts of the shells call it."""

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

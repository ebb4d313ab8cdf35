"""The help of commands: groups of options, an example, and a layout that narrow terminals can show."""

import re
from dataclasses import dataclass
from typing import Annotated, Literal

import pytest

from imuwb.cli.help import parted
from imuwb.cli.parameters import metavar, parameters_of
from imuwb.options import Group, options_of

HEADING = re.compile(r"^(\S.*):$", re.MULTILINE)


@pytest.mark.parametrize("columns", ["40", "80", "120"])
def test_the_help_of_the_command_with_the_most_options_fits_the_terminal(imuwb, columns):
    shown = imuwb("outage", "--help", COLUMNS=columns).out
    groups = HEADING.findall(shown[shown.index("\nThe log:") :])
    assert groups[-5:] == ["How the log is read", "Conditioners", "Output", "General", "Example"]
    assert {"What to compare", "Geometry and clocks", "Aids"} < set(groups)
    assert len(groups) == len(set(groups))
    body = shown.partition("Example:")[0]
    # A pattern without blanks cannot be broken; it has a line of its own.
    assert not [line for line in body.splitlines() if len(line) > int(columns) and not line.startswith("  --")]
    assert shown.rstrip().splitlines()[-1].startswith("  ")


def test_every_command_ends_with_an_example_that_names_it(imuwb):
    for command in (
        ["info"],
        ["convert"],
        ["noise"],
        ["model", "check"],
        ["simulate", "chamber"],
        ["calibration", "rate-table"],
    ):
        last = imuwb(*command, "--help", COLUMNS="100").out.rpartition("Example:")[2]
        assert " ".join(last.split()).startswith(f"imuwb {' '.join(command)} ")


def test_a_plugin_without_groups_and_example_has_both(imuwb, tmp_path):
    (tmp_path / "mine.py").write_text(
        "from dataclasses import dataclass\n@dataclass(frozen=True)\nclass Parameters:\n    axis: str = 'z'\n"
        "def run(logs, parameters): ...\ndef draw(result, review): ...\n", "utf-8",
    )  # fmt: skip
    shown = imuwb("./mine.py", "--help").out
    assert HEADING.findall(shown)[1] == "The analysis"
    assert shown.rstrip().endswith("imuwb ./mine.py LOG")


@dataclass(frozen=True)
class Settings:
    sigma: Annotated[float, "sigma (m)", Group("Aids")] = 1.0
    kind: Literal["a", "b"] = "a"


def test_a_parameter_states_its_group():
    assert [option.group for option in options_of(Settings)] == ["Aids", ""]
    marks = [p.annotation.__metadata__[0] for p in parameters_of(Settings)]
    assert [m.rich_help_panel for m in marks] == ["Aids", "The analysis"]
    assert [m.metavar for m in marks] == ["NUMBER", "a|b"]
    assert metavar(int | None) == "N"


def test_a_text_without_an_example_stays_whole():
    assert parted("What it does.\n\nExample: imuwb mine LOG") == ("What it does.", "imuwb mine LOG")
    assert parted("What it does.") == ("What it does.", "")

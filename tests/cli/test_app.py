"""The list of commands, and how dataclasses become options."""

import inspect
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import Annotated

import pytest

from imuwb.cli.app import COMMANDS
from imuwb.cli.demo import LOGS, marked
from imuwb.cli.parameters import expanded, make
from imuwb.errors import UsageError
from imuwb.options import POSITIVE, Form


@pytest.mark.parametrize("name", COMMANDS)
def test_the_line_in_the_list_is_the_first_of_the_commands_own_help(name):
    own = name.replace("-", "_")
    module = import_module(f"imuwb.cli.{own}")
    made = module.build([]) if hasattr(module, "build") else getattr(module, "app", None)
    text = getattr(module, own).__doc__ if made is None else made.info.help
    assert text.splitlines()[0] == COMMANDS[name][1]


def test_every_command_of_the_core_shows_its_help(imuwb):
    shown = imuwb("--help")
    for name in COMMANDS:
        assert f" {name} " in shown.out
        done = imuwb(name, "--help")
        assert (done.code, "Usage: imuwb" in done.out) == (0, True)


def test_the_demo_has_an_analysis_for_each_sample_log():
    assert [marked(log)[0] for log in LOGS] == ["noise", "outage"]


def test_an_unknown_command_is_wrong_usage(imuwb):
    done = imuwb("alan")
    assert (done.code, "allan" in done.err) == (2, True)


@dataclass(frozen=True)
class Route:
    length: Annotated[float, "length (m)", POSITIVE] = 10.0
    arm: Annotated[tuple[float, float, float], Form("F,R,D")] = (0.0, 0.0, 0.0)
    units: dict[str, str] = field(default_factory=dict)


def drive(output: Path, route: Route, *, seed: int = 0) -> None:
    """Drive."""
    raise LookupError(output, route, seed)


def test_a_group_of_options_becomes_an_option_for_each_field():
    command = expanded(drive, {"Route": "The route"})
    options = inspect.signature(command).parameters
    assert list(options) == ["output", "length", "arm", "units", "seed"]
    assert options["arm"].default == "0,0,0"
    typed = options["length"].annotation.__metadata__[0]
    assert (typed.help, typed.rich_help_panel) == ("Length (m).", "The route")
    with pytest.raises(LookupError) as call:
        command(output="x", length=2.0, arm="1,2,3", units=None, seed=4)
    assert call.value.args == ("x", Route(2.0, (1.0, 2.0, 3.0), {}), 4)


def test_an_error_names_the_option_as_users_write_it():
    with pytest.raises(UsageError, match="^--arm is '1,2'"):
        make(Route, {"arm": "1,2"})

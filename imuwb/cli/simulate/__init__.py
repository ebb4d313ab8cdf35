"""Simulate logs of sensors whose errors are known."""

import typer

from imuwb.cli.parameters import expanded
from imuwb.cli.simulate.bench import hand_held, rate_table, six_position
from imuwb.cli.simulate.chamber import chamber
from imuwb.cli.simulate.drive import drive
from imuwb.cli.simulate.options import PANELS
from imuwb.cli.simulate.static import static

app = typer.Typer(no_args_is_help=True, help=__doc__)
for command in (static, chamber, six_position, hand_held, rate_table, drive):
    app.command(command.__name__.replace("_", "-"))(expanded(command, PANELS))

"""imuwb simulate: logs of known truth, of a still IMU, a climate chamber, a calibration bench, and a drive."""

from __future__ import annotations

import typer

from imuwb.cli.simulate.bench import rate_table, six_position
from imuwb.cli.simulate.chamber import chamber
from imuwb.cli.simulate.drive import drive
from imuwb.cli.simulate.static import static

app = typer.Typer(
    no_args_is_help=True,
    help="Simulate logs of sensors whose errors are known.",
)

app.command()(static)
app.command()(chamber)
app.command("six-position")(six_position)
app.command("rate-table")(rate_table)
app.command()(drive)

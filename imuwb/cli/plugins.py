"""imuwb plugins: lists what is installed, writes a new plugin, and checks one."""

from dataclasses import fields
from typing import Any, cast

import typer

from imuwb import registry
from imuwb.cli import check_plugin, new_plugin

app = typer.Typer(
    help="List the installed plugins, write a new one, check one.\n\n"
    "Without a command, all analyses, conditioners and readers are listed, with the parameters of conditioners and the package that each comes from."
)
app.command("new")(new_plugin.new)
app.command("check")(check_plugin.check)

KINDS = (("analysis", registry.ANALYSES), ("conditioner", registry.CONDITIONERS), ("reader", registry.READERS))


@app.callback(invoke_without_command=True)
def plugins(context: typer.Context) -> None:
    """Print the list of plugins, unless a command follows."""
    if context.invoked_subcommand is not None:
        return
    from imuwb.analysis import Table  # noqa: PLC0415 - help must not wait for rich
    from imuwb.cli.terminal import shower  # noqa: PLC0415

    rows: list[tuple[str, ...]] = []
    for kind, group in KINDS:
        for name, point in registry.installed(group).items():
            plugin = registry.load(point)
            text = registry.summary_of(plugin) if plugin is not None else "cannot be loaded"
            if kind == "conditioner" and plugin is not None:
                text += f" ({', '.join(f.name for f in fields(cast('Any', plugin).Parameters))})"
            origin = f"{point.dist.name} {point.dist.version}" if point.dist is not None else "unknown"
            rows.append((kind, name, text, point.value, origin))
    headings = ("kind", "name", "description", "module", "package")
    shower(data=True)(
        Table("Plugins", headings, tuple(rows), "A single .py file is also a plugin: imuwb ./mine.py LOG")
    )

"""imuwb plugins: lists what is installed."""

from dataclasses import fields
from typing import Any, cast

from imuwb import registry

KINDS = (("analysis", registry.ANALYSES), ("conditioner", registry.CONDITIONERS), ("reader", registry.READERS))


def plugins() -> None:
    """List the installed analyses, conditioners and readers.

    The list shows the parameters of conditioners, and the package that each plugin comes from.

    Example: imuwb plugins
    """
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

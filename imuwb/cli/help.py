"""The help of commands as plain text: options in groups, an example at the end.

Option and text stand in two columns; a long option has a line of its own, so that the texts stay wide enough to be read at 80 columns.
"""

import re
import shutil
import textwrap
from collections.abc import Iterable
from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup

NARROWEST, WIDEST = 40, 100  #: columns of a help
MARGIN = 2  #: columns right of a help
FIRST = 26  #: columns of an option, at most; at most a third of the help
LOG, READING, CONDITIONERS, OUTPUT, GENERAL = "The log", "How the log is read", "Conditioners", "Output", "General"
ANALYSIS = "The analysis"  #: group of the options of an analysis that state none
LAST = (READING, CONDITIONERS, OUTPUT, GENERAL)  #: groups at the end
TIE = "\0"  #: a blank at which no line ends
EXAMPLE = "Example:"  #: begin of the last paragraph of a docstring
KINDS = {"int": "N", "float": "NUMBER", "str": "TEXT", "path": "FILE"}  #: type -> what stands for its values
COMMANDS, OPTIONS = "Commands", "Options"
ALWAYS = ("help", "config", "save_config")  #: options that every command has


def columns() -> int:
    """Return the columns of a help on this terminal."""
    return min(max(shutil.get_terminal_size().columns, NARROWEST), WIDEST) - MARGIN


def parted(text: str) -> tuple[str, str]:
    """Return a help without its example, and the example."""
    before, mark, example = text.rpartition(EXAMPLE)
    return (before.rstrip(), example.strip()) if mark else (text, "")


class HelpfulCommand(TyperCommand):
    """A command whose help has its options in groups, and its example at the end."""

    def format_help(self, ctx: Any, formatter: Any) -> None:  # noqa: ANN401 - their types moved between versions of typer
        """Write the help: usage, what the command does, arguments and options by group, the example."""
        self.format_usage(ctx, formatter)
        text, example = parted(self.help or "")
        _write_text(text, formatter)
        groups: dict[str, list[tuple[str, str]]] = {}
        for param in self.get_params(ctx):
            record = param.get_help_record(ctx)
            if record is not None:
                panel = getattr(param, "rich_help_panel", None)
                general = param.name in ALWAYS
                groups.setdefault(panel or (GENERAL if general else OPTIONS), []).append(
                    (_name(param, record[0]), record[1])
                )
        for group in sorted(groups, key=lambda group: (group != LOG, LAST.index(group) if group in LAST else -1)):
            _write_group(group, groups[group], formatter)
        if example or self.epilog:
            formatter.write(f"\n{typer.style(EXAMPLE, bold=True)}\n")
            # An option and its value stay on one line.
            command = re.sub(r"(?<= )(--?[\w-]+) (?=[^-])", f"\\1{TIE}", example or self.epilog or "")
            lines = textwrap.wrap(command, formatter.width - 6, break_long_words=False, break_on_hyphens=False)
            formatter.write(" \\\n      ".join(lines).replace(TIE, " ").join(("  ", "\n")))


class HelpfulGroup(TyperGroup):
    """A group of commands whose help has one line for each command, in groups."""

    def format_help(self, ctx: Any, formatter: Any) -> None:  # noqa: ANN401 - their types moved between versions of typer
        """Write the help: usage, what the group does, its commands, its options."""
        self.format_usage(ctx, formatter)
        _write_text(self.help or "", formatter)
        groups: dict[str, list[tuple[str, str]]] = {}
        for name in self.list_commands(ctx):
            command = self.get_command(ctx, name)
            if command is not None and not command.hidden:
                panel = getattr(command, "rich_help_panel", None)
                first = parted(command.help or "")[0].split("\n\n")[0]
                groups.setdefault(panel or COMMANDS, []).append((name, command.short_help or " ".join(first.split())))
        for group, rows in groups.items():
            _write_group(group, rows, formatter)
        records = [(_name(p, r[0]), r[1]) for p in self.get_params(ctx) if (r := p.get_help_record(ctx)) is not None]
        _write_group(GENERAL, records, formatter)


def _name(param: Any, name: str) -> str:  # noqa: ANN401 - its type moved between versions of typer
    """Return the left column of an option: of a switch that is off, only the word that turns it on."""
    if param.param_type_name == "argument":
        return name.partition(" <")[0]
    if param.is_flag and param.secondary_opts and not param.default:
        return name.partition(" / ")[0]
    return re.sub(r"<(\w+)>", lambda kind: KINDS.get(kind[1], kind[0]), name)


def _write_text(text: str, formatter: Any) -> None:  # noqa: ANN401 - as above
    for paragraph in filter(None, text.split("\n\n")):
        formatter.write("\n" + textwrap.fill(" ".join(paragraph.split()), formatter.width) + "\n")


def _write_group(title: str, rows: Iterable[tuple[str, str]], formatter: Any) -> None:  # noqa: ANN401 - as above
    rows = list(rows)
    if not rows:
        return
    with formatter.section(typer.style(title, bold=True)):
        formatter.write_dl(rows, col_max=min(FIRST, formatter.width // 3))

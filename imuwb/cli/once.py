"""A command whose options may each be given once, unless they take several values."""

from collections import Counter
from typing import Any

from typer.core import TyperOption

from imuwb.cli.help import HelpfulCommand
from imuwb.errors import UsageError


class OnceCommand(HelpfulCommand):
    """A command that refuses an option that is given twice, of which only the last value would count."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:  # noqa: ANN401 - its type moved between versions of typer
        """Read the command line.

        Raises:
            UsageError: an option that takes one value is given twice.
        """
        if not ctx.resilient_parsing:
            _, _, order = self.make_parser(ctx).parse_args(list(args))
            for parameter, count in Counter(order).items():
                if count > 1 and isinstance(parameter, TyperOption) and not (parameter.multiple or parameter.is_flag):
                    raise UsageError(f"{parameter.opts[0]} is given {count} times; state it once")
        return super().parse_args(ctx, args)

"""The rule that every kind of plugin has: its parts are there."""

from collections.abc import Sequence

from imuwb.analysis import offers
from imuwb.testing.outcomes import Outcome, outcome


def parts_outcome(plugin: object, kind: str, parts: Sequence[str], contract: str) -> Outcome:
    """Return whether a plugin has the parts of its kind.

    Args:
        plugin: any.
        kind: "analysis", "conditioner" or "reader".
        parts: names of what it must have, two or more.
        contract: the module that states them.
    """
    lacking = [part for part in parts if not offers(plugin, part)]
    return outcome(
        "parts",
        [f"the {kind} lacks {part}; {contract} has its contract" for part in lacking],
        f"it has {', '.join(parts[:-1])} and {parts[-1]}",
    )

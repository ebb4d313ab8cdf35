"""The rule by which the owners of logs are known."""

from imuwb.cli.fleet.options import Owners
from imuwb.errors import UsageError
from imuwb.fleet.identity import ByGroup, ByMetadata, ByTable, Rule


def rule_of(owners: Owners) -> Rule:
    """Return the rule that the options state.

    Raises:
        UsageError: two options state it, or one is wrong.
    """
    given = [name for name in ("group", "identities", "metadata") if getattr(owners, name) is not None]
    if len(given) > 1:
        raise UsageError(f"--{' and --'.join(given)} state the same; give one of them")
    if owners.group is not None:
        return ByGroup(owners.group)
    if owners.identities is not None:
        return ByTable(owners.identities)
    return ByMetadata(owners.metadata) if owners.metadata is not None else Rule()

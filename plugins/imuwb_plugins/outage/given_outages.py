"""The outages of --at that belong to a log."""

from pathlib import Path

from imuwb.errors import UsageError
from imuwb.log import Log
from imuwb.replay import Outage
from imuwb_plugins.outage.outage_list import given


def name_of(log: Log) -> str:
    """Return the name of a log: that of its file without suffixes."""
    return Path(log.provenance.path).name.partition(".")[0] or log.provenance.path


def outages_of(log: Log, at: object) -> list[Outage]:
    """Return the given outages of a log, in order of time; of equal ones the first.

    Raises:
        UsageError: none of them belongs to the log.
    """
    names = ("", name_of(log), Path(log.provenance.path).name)
    own = [outage for outage in given(at) if outage.log in names]
    if not own:
        raise UsageError(
            f"at {at}: no outage belongs to {log.provenance.path}; the column log must have {name_of(log)!r}"
        )
    first = {(outage.start, outage.duration): outage for outage in reversed(own)}
    return [Outage(start, duration, one.name, one.table) for (start, duration), one in sorted(first.items())]

"""The health of a log."""

from collections.abc import Sequence

from imuwb.health import Health, check
from imuwb.log import Log
from imuwb_plugins.health.parameters import Parameters


def run(logs: Sequence[Log], parameters: Parameters) -> Health:
    """Return what is wrong with the log.

    Raises:
        MissingDataError: it has no stream that can be used.
    """
    logs[0].streams()
    return check(logs[0], lines=parameters.lines)

"""The start of the filters: the heading that is stated, or where it comes from."""

from dataclasses import replace

from imuwb.errors import UsageError
from imuwb.log import Log
from imuwb.navigation import FilterModel
from imuwb.notes import Note
from imuwb.replay import find_start, given_start
from imuwb_plugins.outage.parameters import Parameters


def started(log: Log, base: FilterModel, parameters: Parameters) -> tuple[FilterModel, tuple[Note, ...]]:
    """Return the filter with its start, and a note on where the heading comes from.

    Raises:
        UsageError: a sigma without a heading.
        MissingDataError: no source gives a heading.
    """
    if parameters.start_speed is not None:
        base = replace(base, settings=replace(base.settings, start_speed=parameters.start_speed))
    heading = parameters.heading
    if isinstance(heading, str) and parameters.heading_sigma is not None:
        raise UsageError(f"--heading-sigma needs a stated heading: --heading DEG, not {heading}")
    if not log.gnss:
        return base, ()  # the message on the receiver that is missing comes later
    if isinstance(heading, str):
        start = find_start(log, base, parameters.receiver, heading)
    else:
        start = given_start(
            heading, base.settings.heading if parameters.heading_sigma is None else parameters.heading_sigma
        )
    return (base, ()) if start is None else (start.applied_to(base), (start.note,))

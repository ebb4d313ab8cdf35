"""The reference of --truth: a trajectory of another file, joined to the log."""

from dataclasses import replace
from pathlib import Path

from imuwb.log import Log
from imuwb.navigation import FilterModel
from imuwb.notes import Note
from imuwb.readers import read_trajectory
from imuwb.replay import Placing, external_reference, receiver_of
from imuwb_plugins.outage.given_outages import name_of
from imuwb_plugins.outage.parameters import Parameters


def with_truth(log: Log, base: FilterModel, parameters: Parameters) -> tuple[Log, tuple[Note, ...]]:
    """Return the log with the reference of --truth before its own references, and notes; the log itself without --truth.

    Raises:
        MissingDataError: the file has no trajectory, or none within the log's time.
        UsageError: the file needs an option, or does not fit the log.
        UnreadableLogError: the file cannot be read.
    """
    if parameters.truth is None:
        return log, ()
    path = Path(str(parameters.truth).replace("{log}", name_of(log)))
    found = read_trajectory(path, parameters.truth_times, log.zero)
    delay = base.installation.gnss_delay if parameters.truth_delay == "gnss" else parameters.truth_delay
    placing = Placing(delay, parameters.truth_lever, parameters.truth_origin, parameters.truth_axes)
    reference, notes = external_reference(found, log, receiver_of(log, parameters.receiver), placing, "truth")
    reference = replace(
        reference, name=f"{reference.name} of {path.name}" if reference.name != path.name else path.name
    )
    used = Note("truth", f"{path}: {reference.name} is the log's first reference")
    return replace(log, references=(reference, *log.references)), (used, *notes)

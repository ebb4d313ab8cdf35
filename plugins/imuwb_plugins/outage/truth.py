"""The reference of --truth: a trajectory of another file, joined to the log."""

from dataclasses import replace
from pathlib import Path

from imuwb.errors import UsageError
from imuwb.geodesy.local_track import LocalTrack
from imuwb.log import SECOND, Log, Reference
from imuwb.navigation import FilterModel
from imuwb.notes import Note
from imuwb.readers import read_trajectory
from imuwb.replay import Placing, check_reference, external_reference, receiver_of
from imuwb.replay.references.reference import truth_of
from imuwb_plugins.outage.given_outages import name_of
from imuwb_plugins.outage.parameters import Parameters


def truth_file(log: Log, parameters: Parameters) -> tuple[Path, Log | LocalTrack | Reference] | None:
    """Return the file of --truth and what it has, before any work is done; None without --truth.

    Raises:
        MissingDataError: the file has no trajectory.
        UsageError: the file needs an option; or without --truth, there is no reference of the wanted name.
        UnreadableLogError: the file cannot be read.
    """
    if parameters.truth is None:
        check_reference(log, parameters.wanted_reference)
        return None
    path = Path(str(parameters.truth).replace("{log}", name_of(log)))
    return path, read_trajectory(path, parameters.truth_times, log.zero)


def with_truth(
    log: Log, base: FilterModel, parameters: Parameters, given: tuple[Path, Log | LocalTrack | Reference] | None
) -> tuple[Log, tuple[Note, ...]]:
    """Return the log with the reference of --truth before its own references, and notes; the log itself without --truth.

    Raises:
        MissingDataError: the file has no trajectory within the log's time.
        UsageError: the file does not fit the log.
    """
    delay = base.installation.gnss_delay if parameters.truth_delay == "gnss" else parameters.truth_delay
    if given is None:
        return _own(log, delay, parameters), ()
    path, found = given
    placing = Placing(delay, parameters.truth_lever, parameters.truth_origin, parameters.truth_axes)
    reference, notes = external_reference(found, log, receiver_of(log, parameters.receiver), placing, "truth")
    reference = replace(
        reference, name=f"{reference.name} of {path.name}" if reference.name != path.name else path.name
    )
    used = Note("truth", f"{path}: {reference.name} is the log's first reference")
    return replace(log, references=(reference, *log.references)), (used, *notes)


def _own(log: Log, delay: float, parameters: Parameters) -> Log:
    """Return the log with the delay and the lever arm of its own truth."""
    if not delay and not any(parameters.truth_lever):
        return log
    if truth_of(log) is None:
        raise UsageError(
            f"{log.provenance.path}: the log has no truth of its own, so --truth-delay and --truth-lever need --truth FILE"
        )
    return replace(
        log,
        references=tuple(
            r
            if r.origin.by_filter
            else replace(r, time=r.time - round(delay * SECOND), lever_arm=parameters.truth_lever)
            for r in log.references
        ),
    )

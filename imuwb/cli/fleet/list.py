"""imuwb fleet list: the logs that patterns name."""

import csv
import io
from collections import Counter
from datetime import timedelta
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from imuwb.cli.fleet.options import OWNERS, PATTERNS, Owners
from imuwb.cli.options import Force, output_option
from imuwb.texts import counted
from imuwb.units import UNIX_EPOCH

if TYPE_CHECKING:
    from collections.abc import Sequence

    from imuwb.analysis import Answer
    from imuwb.fleet.plan import Task
    from imuwb.fleet.triage import Triage

FORMATS, FAULTS = 6, 2  #: that are shown
PANELS = {"Owners": OWNERS}
COLUMNS = ("log", "size", "format", "imus", "rate", "duration", "vehicle", "serial", "family", "date", "fault")


def list_logs(
    *,
    logs: Annotated[list[str], PATTERNS],
    owners: Owners,
    output: Annotated[
        Path | None,
        output_option(
            "--output", "-o", text="Also write a row for each log; a table for --identities.", metavar="FILE.csv"
        ),
    ] = None,
    force: Force = False,
) -> None:
    """List the logs that patterns name, and whose they are; nothing is analysed.

    Only the index of a log is read, or its first bytes.

    Example: imuwb fleet list 'logs/**/*.mcap' --group '(?P<vehicle>[^/]+)/(?P<serial>[^/]+)/[^/]+$'
    """
    from imuwb.cli.fleet.owners import rule_of  # noqa: PLC0415 - help must not wait
    from imuwb.cli.places import check_place, check_places  # noqa: PLC0415
    from imuwb.cli.terminal import print_panel  # noqa: PLC0415
    from imuwb.fleet.listing import found  # noqa: PLC0415
    from imuwb.fleet.plan import planned  # noqa: PLC0415
    from imuwb.fleet.triage import triaged  # noqa: PLC0415
    from imuwb.readers.bytes.address import place_of  # noqa: PLC0415
    from imuwb.review.answers.panel import Origin  # noqa: PLC0415
    from imuwb.writers import write_text  # noqa: PLC0415

    if output is not None:
        check_place(output, force=force)
    rule = rule_of(owners)
    tasks = planned(found(logs), rule, ())
    if output is not None and output.exists():
        inputs = [place_of(task.log.place) for task in tasks]
        check_places([output], [*inputs, *filter(None, (owners.identities,))], force=force)
    known = list(triaged([task.log for task in tasks]))
    if output is not None:
        write_text(output, _csv(tasks, known))
    wrote = () if output is None else (str(output),)
    print_panel(
        _answer(tasks, known, rule.unused([task.log for task in tasks])),
        Origin("fleet list", tuple(logs), wrote=wrote),
        data=output is None,
    )


def _csv(tasks: "Sequence[Task]", known: "Sequence[Triage]") -> str:
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(COLUMNS)
    for task, one in zip(tasks, known, strict=True):
        who, log, imus = task.identity, one.log, " ".join(one.topics)
        date = None if who.date is None else (UNIX_EPOCH + timedelta(microseconds=who.date // 1000)).isoformat()
        owner = who.vehicle, who.serial, who.family, date
        table.writerow((log.place, log.size, one.format, imus, one.rate, one.duration, *owner, one.fault))
    return text.getvalue()


def _answer(tasks: "Sequence[Task]", known: "Sequence[Triage]", unused: str) -> "Answer":
    from imuwb.analysis import Answer  # noqa: PLC0415 - as above
    from imuwb.fleet.owned import owned  # noqa: PLC0415 - as above
    from imuwb.texts import bytes_text, duration_text  # noqa: PLC0415 - as above

    formats = Counter(one.format or "no log" for one in known)
    whose = owned((task.identity.vehicle, task.identity.serial) for task in tasks)
    times = [one.duration for one in known if one.duration is not None]
    total = f"{bytes_text(sum(one.log.size for one in known))} in all"
    indexed = (
        f"the indexes of {counted(len(times), 'log')} state {duration_text(sum(times))}"
        if times
        else "no log has an index that states its duration"
    )
    sentences = (
        f"{total}; {indexed}.",
        *whose.sentences(),
        *filter(None, (unused,)),
        *[one.fault for one in known if one.fault][:FAULTS],
    )
    rows = tuple((name, str(count)) for name, count in formats.most_common(FORMATS))
    return Answer(
        f"{counted(len(known), 'log')} of {whose.text}",
        ("format", "logs"),
        rows,
        sentences,
    )

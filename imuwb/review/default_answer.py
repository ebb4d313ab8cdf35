"""The answer of an analysis that states none itself: its first table and its first notes."""

from collections.abc import Sequence

from imuwb.analysis import Answer, Table
from imuwb.log import Log
from imuwb.sampling import sampling
from imuwb.texts import number_text, seconds_text

ROWS, NOTES, COLUMNS = 8, 3, 5  #: of the table, and of the notes


def default_answer(logs: Sequence[Log], shown: Sequence[Table | str]) -> Answer:
    """Return an answer made of what an analysis has shown.

    Args:
        logs: that were analysed.
        shown: tables and notes, in order.
    """
    table = next((item for item in shown if isinstance(item, Table)), None)
    notes = tuple(item for item in shown if isinstance(item, str))[:NOTES]
    if table is None:
        return Answer(about(logs), sentences=notes)
    rows = tuple(row[:COLUMNS] for row in table.rows[:ROWS])
    return Answer(about(logs), table.headings[:COLUMNS], rows, notes)


def about(logs: Sequence[Log]) -> str:
    """Return how much was analysed: 2.8 h, 100 Hz."""
    log = logs[0]
    triads = [t for imu in log.imus for t in (imu.angular_rate, imu.specific_force) if t is not None and len(t) > 1]
    timed = triads or [s for s in (*log.gnss, *log.speeds, *log.references) if len(s) > 1]
    if not timed:
        return "no rows"
    time = timed[0].time
    rate = sampling(time).rate or 0.0
    return f"{seconds_text((int(time[-1]) - int(time[0])) / 1e9)}, {number_text(rate)} Hz"

"""The answer of an analysis that states none itself: its first table and its first notes."""

from collections.abc import Sequence

from imuwb.analysis import Answer, Step, Table
from imuwb.log import Log
from imuwb.sampling import sampling
from imuwb.texts import duration_text, number_text

ROWS, NOTES, COLUMNS = 8, 3, 5  #: of the table, and of the notes
ALL = Step("{command} --full", "all tables and notes")


def default_answer(logs: Sequence[Log], shown: Sequence[Table | str]) -> Answer:
    """Return an answer made of what an analysis has shown.

    Args:
        logs: that were analysed.
        shown: tables and notes, in order.
    """
    table = next((item for item in shown if isinstance(item, Table)), None)
    notes = tuple(item for item in shown if isinstance(item, str))[:NOTES]
    rows = () if table is None else tuple(row[:COLUMNS] for row in table.rows[:ROWS])
    headings = () if table is None else table.headings[:COLUMNS]
    whole = table is None or (len(rows) == len(table.rows) and len(headings) == len(table.headings))
    steps = () if whole and len(shown) == len(notes) + (table is not None) else (ALL,)
    return Answer(about(logs), headings, rows, notes, steps)


def about(logs: Sequence[Log]) -> str:
    """Return how much was analysed: 2.8 h, 100 Hz."""
    log = logs[0]
    triads = [t for imu in log.imus for t in (imu.angular_rate, imu.specific_force) if t is not None and len(t) > 1]
    timed = triads or [s for s in (*log.gnss, *log.speeds, *log.references) if len(s) > 1]
    if not timed:
        return "no rows"
    time = timed[0].time
    rate = sampling(time).rate or 0.0
    return f"{duration_text((int(time[-1]) - int(time[0])) / 1e9)}, {number_text(rate)} Hz"

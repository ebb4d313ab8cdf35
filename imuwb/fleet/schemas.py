"""The tables of a fleet: their columns, units and keys, and the folder of results.

A folder of results, on a disk or in an object store, has

* ``run.json``: what was run (``RUN_KEYS``); it is written when a run begins, and again when it ends;
* ``logs.parquet``: a row for each log that was found;
* ``sensors.parquet``: a row for each coefficient that an analysis finds for an axis of a log, and for each figure of its answer
  if it has no findings;
* ``outages.parquet``: a row for each filter in each outage;
* ``quarantine.parquet``: a row for each log, or part of one, that gives no result, with the reason;
* ``progress.jsonl``: a line for each log that was ready, in the order of time; the last run only;
* ``parts/RUN/CC/TAG.CONTENT.parquet``: what one task found. RUN is a hash of the analysis, its parameters and the versions, TAG one
  of the size and time of a file, or of the size and tag of an object, CONTENT one of the bytes of the log, and CC its first letters.

All values are in SI units (temperatures in °C); ``unit`` names the unit of the three numbers of a row. A text of a log is cleaned
of controls; a path is as it can be opened, and whoever shows it cleans it. The rows of a table are in a fixed order (``ORDER``), so the same logs give the same bytes. The file of a table states
its name and ``SCHEMA`` in its metadata, as ``imuwb.table`` and ``imuwb.schema``. A reader must accept further columns; a column
that changes or goes away raises ``SCHEMA``.
"""

import pyarrow as pa

from imuwb.errors import UsageError

SCHEMA = 1
TABLE_KEY, SCHEMA_KEY = b"imuwb.table", b"imuwb.schema"  #: in the metadata of a file
SOUND, SUSPICIOUS = "sound", "suspicious"  #: verdicts of a row of sensors
DUPLICATE = "duplicate"  #: kind of a row of quarantine: a copy of a log that counts
DONE, QUARANTINED = "done", "quarantined"  #: states of a row of logs

#: keys of run.json: schema (of the tables), imuwb (version), analysis (name with its method), params (of the analysis), command,
#: inputs (the patterns), executor ("this process", "4 processes", "tcp://..."), run (name of the folder of parts), state ("running",
#: "interrupted", "ended"), logs (found), done, quarantined, level (probability of the intervals, or null), digest (of what the tables
#: are made of; empty: they are not written), tables (hash of their bytes)
RUN_KEYS = (
    "schema", "imuwb", "analysis", "params", "command", "inputs", "executor", "run", "state", "logs", "done", "quarantined", "level", "digest", "tables",
)  # fmt: skip

_WHO = (
    ("vehicle", pa.string()),  # null: not known
    ("serial", pa.string()),  # serial number or name of the sensor; null: not known
    ("family", pa.string()),  # type of the sensor, whose members are alike; null: not known
)
_WHEN = (
    ("temperature", pa.float64()),  # °C, mean of the thermometer of the IMU; null: the log has none
    ("duration", pa.float64()),  # s, of the stream
    (
        "start",
        pa.timestamp("ns", tz="UTC"),
    ),  # first sample; or the date that the user states, which beats it; null: the clock counts from the boot
)


def _schema(table: str, *columns: tuple[str, pa.DataType]) -> pa.Schema:
    return pa.schema(columns, metadata={TABLE_KEY: table.encode(), SCHEMA_KEY: str(SCHEMA).encode()})


SENSORS = _schema(
    "sensors",
    *_WHO,
    ("analysis", pa.string()),  # with its method: "calibration six-position"
    ("stream", pa.string()),  # name of the IMU in the log
    ("axis", pa.string()),  # gyro_x ... accel_z; empty: of the whole log
    ("coefficient", pa.string()),  # Q, N, B, K, R, or the name of a figure of the answer
    ("value", pa.float64()),  # null: the log does not show the coefficient; then upper is its limit
    ("lower", pa.float64()),  # null: no lower end
    (
        "upper",
        pa.float64(),
    ),  # upper end of the interval, or the limit, which is one-sided; null: the log gives no bound
    ("unit", pa.string()),  # SI
    ("level", pa.float64()),  # probability of the interval, and of the limit; null: not stated
    ("estimator", pa.string()),
    (
        "headline",
        pa.bool_(),
    ),  # whether an error model takes the value; false: another estimator of the same coefficient
    *_WHEN,
    ("log", pa.string()),  # key in the table of logs
    ("verdict", pa.string()),  # "sound" or "suspicious": a remark puts the value in doubt
    ("remarks", pa.string()),  # of the estimator on this axis, "; " between them
)
OUTAGES = _schema(
    "outages",
    *_WHO,
    ("analysis", pa.string()),
    ("filter", pa.string()),
    ("name", pa.string()),  # as the user gives it; mostly empty
    ("outage_start", pa.float64()),  # s from the start of the log
    ("outage_duration", pa.float64()),  # s
    ("motion", pa.string()),  # "stop", "turn", "fast" or "straight"
    ("mean_speed", pa.float64()),  # m/s
    ("mean", pa.float64()),  # m, mean of the horizontal error
    ("max", pa.float64()),  # m, the largest
    ("end", pa.float64()),  # m, at the end
    ("vertical", pa.float64()),  # m, at the end
    ("velocity", pa.float64()),  # m/s, at the end
    ("heading", pa.float64()),  # rad, at the end; null: the reference has no heading
    ("share", pa.float64()),  # of the distance driven, 1, at the end; null: too slow
    ("sigma", pa.float64()),  # m, of the filter itself, at the end; null: it states none
    ("nees", pa.float64()),  # at the end, two degrees of freedom; null: no sigma
    *_WHEN,
    ("log", pa.string()),
)
LOGS = _schema(
    "logs",
    (
        "log",
        pa.string(),
    ),  # key: "sha256:..." of the bytes, or of the ends of a large log of which a part is read; null: not read
    ("path", pa.string()),  # or address, without secrets
    ("size", pa.int64()),  # bytes
    ("tag", pa.string()),  # hash of the size and time of the file, or of the size and tag of the object
    ("format", pa.string()),  # null: not known
    *_WHO,
    ("imu", pa.string()),  # name of the first IMU; null: none
    ("rate", pa.float64()),  # Hz, of that IMU
    ("streams", pa.int64()),  # number; null: not known
    *_WHEN,
    ("state", pa.string()),  # "done" or "quarantined"
)
QUARANTINE = _schema(
    "quarantine",
    ("path", pa.string()),
    ("log", pa.string()),  # null: not read
    *_WHO,
    ("stage", pa.string()),  # "triage", "identity", "read", "analyse"
    # "unreadable", "lacks data", "usage", "fault", "time", "memory", "transport", "lost", "duplicate", "not known"
    ("kind", pa.string()),
    ("message", pa.string()),
)  # fmt: skip

TABLES = {"logs": LOGS, "sensors": SENSORS, "outages": OUTAGES, "quarantine": QUARANTINE}
#: columns by which the rows of a table are sorted; a null is before every value
ORDER = {
    "logs": ("path",),
    "sensors": ("family", "vehicle", "serial", "start", "log", "analysis", "stream", "axis", "coefficient", "estimator"),
    "outages": ("family", "vehicle", "serial", "start", "log", "analysis", "filter", "outage_duration", "outage_start", "name"),
    "quarantine": ("path", "stage", "kind", "message"),
}  # fmt: skip


def file_of(table: str) -> str:
    """Return the name of the file of a table."""
    return f"{table}.parquet"


def check_schema(table: str, stated: pa.Schema, place: str) -> None:
    """Raise UsageError unless a file has a table of this version.

    Args:
        table: its name.
        stated: schema of the file.
        place: of the file, for the message.
    """
    metadata = stated.metadata or {}
    version = metadata.get(SCHEMA_KEY, b"").decode("utf-8", "replace")
    if metadata.get(TABLE_KEY) != table.encode() or not version:
        raise UsageError(f"{place}: this is no table {table!r} of a fleet; imuwb fleet ANALYSIS -o FOLDER writes one")
    if version != str(SCHEMA):
        raise UsageError(
            f"{place}: it has the schema {version[:20]}, and this version of imuwb reads {SCHEMA}; run the fleet again into a new folder, "
            "or read it with the version that wrote it"
        )
    wrong = [f.name for f in TABLES[table] if f.name not in stated.names or stated.field(f.name).type != f.type]
    if wrong:
        raise UsageError(f"{place}: the columns {', '.join(wrong)} are missing or of another type; the file is damaged")

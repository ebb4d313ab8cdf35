"""Tables of a fleet whose truth is known: one sensor drifts, three are out of family, some logs are damaged."""

import json
from io import BytesIO

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from imuwb import __version__
from imuwb.fleet.schemas import SCHEMA, TABLES, file_of
from imuwb.statistics.distributions import chi_square_limits
from imuwb.units import coefficient_units

BEGIN, DAY = 1_767_225_600_000_000_000, 86_400_000_000_000  # 2026-01-01, ns
AXES = ("gyro_x", "gyro_y", "accel_z")
TRUTH = {
    ("gyro", "N"): 0.25,
    ("gyro", "B"): 8.0,
    ("accel", "N"): 0.05,
    ("accel", "B"): 0.4,
}  # deg/√h, deg/h; m/s/√h, m/s/h
DRIFTING, OUT = "SN007", {"SN013": 0.35, "SN021": -0.35, "SN039": 0.45}
FAULTS = (
    ("read", "unreadable", "the file is cut after 1024 bytes"), ("analyse", "lacks data", "the record is too short"),
    ("analyse", "time", "it took longer than 60 s"),
)  # fmt: skip


def rows_of(*, sensors=40, logs=5, planted=True, outages=True, damaged=18, seed=1, nu=(5000.0, 10.0), serial=True):
    """Return name -> rows of the tables of a fleet."""
    rng = np.random.default_rng(seed)
    rows = {name: [] for name in TABLES}
    scale = {(axis, letter): np.exp(0.05 * rng.standard_normal(sensors)) for axis in AXES for letter in "NB"}
    risk = np.exp(0.1 * rng.standard_normal(sensors))
    for sensor in range(sensors):
        name = f"SN{sensor:03d}"
        for log in range(logs):
            who = {
                "vehicle": f"V{sensor // 2:02d}" if serial else None,
                "serial": name if serial else None,
                "family": "ICM-20948",
            }
            when = {
                "temperature": float(rng.normal(25, 6)),
                "duration": 60.0,
                "start": int(BEGIN + (30 * log + rng.uniform(0, 5)) * DAY),
            }
            key = f"sha256:{sensor:04d}{log:04d}"
            path = f"logs/{name}/run {log}.mcap"
            rows["logs"].append({
                "log": key, "path": path, "size": 1000, "tag": "t", "format": "mcap", **who, "imu": "/imu", "rate": 100.0, "streams": 1,
                **when, "state": "done",
            })  # fmt: skip
            for (axis, letter), factors in scale.items():
                si = coefficient_units(axis, letter)
                y = np.log(si[1].to_si(TRUTH[axis.partition("_")[0], letter]) * factors[sensor])
                if planted and letter == "N" and axis.startswith("gyro"):
                    y += OUT.get(name, 0.0) + (0.08 * log / max(logs - 1, 1)) * (name == DRIFTING)
                own = nu["NB".index(letter)]
                value = float(np.exp(y) * np.sqrt(rng.chisquare(own) / own))
                low, high = (float(np.sqrt(x)) for x in chi_square_limits(0.95, own))
                rows["sensors"].append({
                    **who, "analysis": "noise", "stream": "/imu", "axis": axis, "coefficient": letter, "value": value, "lower": value * low,
                    "upper": value * high, "unit": si[0].name, "level": 0.95, "estimator": "likelihood", "headline": True, **when, "log": key,
                    "verdict": "sound", "remarks": "",
                })  # fmt: skip
                rows["sensors"].append(
                    {**rows["sensors"][-1], "value": value * 2, "estimator": "allan", "headline": False}
                )
            rows["sensors"].append({
                **rows["sensors"][-2], "coefficient": "K", "value": None, "lower": None, "upper": 1e-6, "unit": coefficient_units("accel_z", "K")[0].name,
            })  # fmt: skip
            if outages:
                rows["outages"] += _outages(
                    rng, who, when, key, risk[sensor] * (1.9 if planted and name in ("SN030", "SN031") else 1.0)
                )
    for i in range(damaged):
        stage, kind, message = FAULTS[i % len(FAULTS)]
        path = f"logs/SN{i:03d}/damaged {i}.mcap"
        who = {"vehicle": None, "serial": f"SN{i:03d}" if serial else None, "family": None}
        rows["quarantine"].append({"path": path, "log": None, **who, "stage": stage, "kind": kind, "message": message})
        rows["logs"].append({"log": None, "path": path, "size": 10, "tag": "t", **who, "state": "quarantined"})
    return rows


def _outages(rng, who, when, key, risk):
    rows = []
    for name, size, ratio in (("full", 12.0, 1.0), ("15AV", 15.0, 2.0)):
        for start in np.arange(30.0, 300.0, 30.0):
            end = float(size * risk * np.sqrt(rng.chisquare(2) / 2))
            rows.append({
                **who, "analysis": "outage", "filter": name, "name": "", "outage_start": start, "outage_duration": 60.0, "motion": "fast",
                "mean_speed": 10.0, "mean": end / 2, "max": end, "end": end, "vertical": 1.0, "velocity": 0.5, "heading": 0.01, "share": 0.02,
                "sigma": size / ratio, "nees": float(ratio**2 * rng.chisquare(2)), **when, "log": key,
            })  # fmt: skip
    return rows


def tables_of(rows):
    """Return name -> table."""
    return {name: pa.Table.from_pylist(rows[name], schema) for name, schema in TABLES.items()}


def write(folder, rows, **changed):
    """Write a folder of results; ``changed`` are keys of run.json."""
    folder.mkdir(exist_ok=True)
    for name, table in tables_of(rows).items():
        sink = BytesIO()
        pq.write_table(table, sink)
        (folder / file_of(name)).write_bytes(sink.getvalue())
    logs, bad = len(rows["logs"]), len(rows["quarantine"])
    state = {
        "imuwb": __version__, "analysis": "noise", "params": {}, "command": "imuwb fleet noise 'logs/**/*.mcap' -o results",
        "inputs": ["logs/**/*.mcap"], "executor": "this process", "run": "r", "level": 0.95, "state": "ended", "logs": logs, "done": logs - bad,
        "quarantined": bad, "digest": "d", "schema": SCHEMA,
    } | changed  # fmt: skip
    (folder / "run.json").write_text(json.dumps(state), "utf-8")
    return folder

"""Parts become tables: rows in one order, limits as limits, copies counted once, versions checked."""

import io
from types import SimpleNamespace

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from imuwb.analysis import SUSPICIOUS, Answer, Drift, Finding
from imuwb.errors import ImuwbError, UsageError
from imuwb.fleet import schemas
from imuwb.fleet.found import log_row, outage_rows, sensor_rows
from imuwb.fleet.identity import Identity
from imuwb.fleet.listing import Listed
from imuwb.fleet.parts import Part, known_parts, part_name, same_content, stopped_content
from imuwb.fleet.plan import Task
from imuwb.fleet.store import FolderStore
from imuwb.fleet.tables import Entry, read_table, tables_of
from imuwb.simulation import preset, static
from imuwb.statistics import Coefficient, Estimate


@pytest.fixture(scope="module")
def still():
    return static(preset("3dm-gx3-25"), 10, 50, 1)


def rows_of(log, findings=(), numbers=None, drifts=()):
    answer = Answer("", numbers=numbers or {})
    parts = {"findings": findings, "answer": answer, "drifts": drifts}
    plugin = SimpleNamespace(**{name: lambda _, value=value: value for name, value in parts.items()})
    parameters = SimpleNamespace(level=0.9)
    return list(sensor_rows("mine", plugin, parameters, None, log)), list(outage_rows("mine", plugin, None, log))


def test_findings_become_rows_in_si_units(still):
    known, limit = Coefficient(2.0, 1.0, 3.0, "deg/√h"), Coefficient(None, None, 4e-6)
    findings = (
        Finding("gyro_x", "allan", {"N": known, "K": limit}, headline=True),
        Finding("gyro_y", "psd", {"N": Coefficient(None, None, float("inf"))}, (f"{SUSPICIOUS}shaken",)),
    )
    (white, walk, unknown), _ = rows_of(still, findings)
    assert white["value"] == pytest.approx(2 * 3.14159265 / 180 / 60)
    assert (white["unit"], white["level"], white["verdict"], white["headline"]) == ("rad/s/√Hz", 0.9, "sound", True)
    assert (walk["value"], walk["lower"], walk["upper"], walk["unit"]) == (None, None, 4e-6, "rad/s/√s")
    assert (unknown["value"], unknown["upper"], unknown["verdict"]) == (None, None, "suspicious")
    assert white["duration"] == pytest.approx(10, abs=0.1)
    assert white["log"] == still.provenance.hash


def test_without_findings_the_numbers_of_the_answer_become_rows(still):
    (row,), _ = rows_of(still, numbers={"gyro x line": Estimate(2.0, 1.0, 3.0, unit="kHz")})
    assert (row["coefficient"], row["value"], row["unit"], row["axis"]) == ("gyro x line", 2000.0, "Hz", "")


def test_drifts_become_rows(still):
    _, (row,) = rows_of(
        still, drifts=(Drift("full", 60.0, 30.0, 5.0, 2.0, 6.0, 1.0, 0.2, sigma=float("nan"), motion="turn"),)
    )
    assert (row["filter"], row["outage_duration"], row["end"], row["sigma"], row["heading"]) == (
        "full",
        30.0,
        5.0,
        None,
        None,
    )


def task(place, serial, options=""):
    return Task(
        Listed(place, 10, f"tag {place}"),
        Identity("v", serial),
        (),
        options,
        f"tag {place} {options}".replace(" ", "-"),
    )


@pytest.fixture
def results(tmp_path, still):
    store = FolderStore(tmp_path)
    sensors, outages = rows_of(still, (Finding("gyro_x", "allan", {"N": Coefficient(2.0, 1.0, 3.0)}),))
    entries = []
    for place, key in (("b.csv", "sha256:1"), ("a.csv", "sha256:2"), ("copy.csv", "sha256:1")):
        own = task(place, place[0])
        part = Part({**log_row(still), "log": key}, tuple({**row, "log": key} for row in sensors), tuple(outages))
        name = part_name("run", own.tag, key[-1] * 16)
        store.create(name, part.packed())
        entries.append(Entry(own, name))
    entries.append(Entry(task("c.csv", None), "", {"stage": "analyse", "kind": "lost", "message": "gone"}))
    return store, entries


def test_the_order_of_the_parts_does_not_change_a_byte(results, tmp_path):
    store, entries = results
    tables_of(entries, store).write(store)
    before = {name: store.read(schemas.file_of(name)) for name in schemas.TABLES}
    tables_of(entries[::-1], store).write(store)
    assert before == {name: store.read(schemas.file_of(name)) for name in schemas.TABLES}
    for name, schema in schemas.TABLES.items():
        assert read_table(store, name, "results").schema.equals(schema, check_metadata=True)
        assert set(schemas.ORDER[name]) <= set(schema.names)


def test_a_copy_of_a_log_counts_once(results):
    store, entries = results
    tables = tables_of(entries, store).by_name
    assert tables["logs"].column("path").to_pylist() == ["a.csv", "b.csv", "c.csv", "copy.csv"]
    assert tables["logs"].column("state").to_pylist() == ["done", "done", "quarantined", "quarantined"]
    assert tables["sensors"].column("serial").to_pylist() == ["a", "b"]
    assert tables["quarantine"].column("kind").to_pylist() == ["lost", "duplicate"]
    (copied,) = [text for text in tables["quarantine"].column("message").to_pylist() if "same bytes" in text]
    assert "b.csv" in copied
    assert "of b, this one of c" in copied


def test_a_date_of_the_user_beats_the_clock_of_the_log(results):
    store, entries = results
    own = entries[0].task
    dated = Entry(Task(own.log, Identity("v", "b", date=5), (), "", own.tag), entries[0].part)
    assert tables_of([dated], store).by_name["sensors"].column("start").cast(pa.int64()).to_pylist() == [5]


def test_a_task_that_was_stopped_is_tried_again_with_other_bounds(results):
    store, _ = results
    store.create(part_name("run", "late", stopped_content(60)), Part(quarantine=({"kind": "time"},)).packed())
    assert "late" in known_parts(store, "run", [stopped_content(60)])
    assert "late" not in known_parts(store, "run", [stopped_content(90)])
    assert len(known_parts(store, "run", [])) == 3
    assert same_content(store, "run", "2" * 16) is not None
    assert same_content(store, "run", "3" * 16) is None


@pytest.mark.parametrize("order", [1, -1])
def test_a_log_that_was_read_beats_its_stop_in_any_order(order):
    bounds = stopped_content(60)
    names = [part_name("run", "late", content) for content in (bounds, "2" * 16, "1" * 16)]
    store = SimpleNamespace(names=lambda _: names[::order])
    assert known_parts(store, "run", [bounds]) == {"late": names[1]}


def test_a_table_of_another_version_is_refused(results):
    store, entries = results
    tables_of(entries, store).write(store)
    table = pq.read_table(io.BytesIO(store.read("sensors.parquet")))
    for metadata, word in (({schemas.TABLE_KEY: b"sensors", schemas.SCHEMA_KEY: b"99"}, "99"), ({}, "no table")):
        sink = io.BytesIO()
        pq.write_table(table.replace_schema_metadata(metadata), sink)
        store.write("sensors.parquet", sink.getvalue())
        with pytest.raises(UsageError, match=word):
            read_table(store, "sensors", "results")
    store.write("sensors.parquet", b"PAR1")
    with pytest.raises(UsageError, match=r"results/sensors\.parquet"):
        read_table(store, "sensors", "results")


def test_a_damaged_part_is_named(results):
    store, entries = results
    store.write(entries[0].part, b"PAR1")
    with pytest.raises(ImuwbError, match=r"parts/run/.*\.parquet"):
        tables_of(entries, store)


@pytest.mark.parametrize(
    "columns", [{"value": [1.0]}, {"logs": [[]], "sensors": [[]], "outages": [[]], "quarantine": [[]]}]
)
def test_a_table_that_is_no_part_is_refused(columns):
    sink = io.BytesIO()
    pq.write_table(pa.table(columns), sink)
    with pytest.raises(ValueError, match="no part"):
        Part.unpacked(sink.getvalue())

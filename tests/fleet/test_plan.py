"""What a fleet has to do: the logs that patterns name, whose they are, and the order of the tasks."""

from pathlib import Path

import numpy as np
import pytest
from mcap.writer import Writer

from imuwb.errors import UsageError
from imuwb.fleet.identity import NOBODY, ByGroup, ByMetadata, ByTable, Identity
from imuwb.fleet.listing import Listed, found
from imuwb.fleet.plan import ordered, planned
from imuwb.readers.stated import stated

GROUP = r"(?P<vehicle>[^/]+)/(?P<serial>[^/]+)/(?P<date>\d{8})?[^/]*$"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("v1/s1/20260102.csv", "v1/s1/b.csv", "v2/s[2]/a.csv", "v2/s[2]/a.csv.toml", "v2/.hidden"):
        Path(name).parent.mkdir(parents=True, exist_ok=True)
        Path(name).write_text(name)
    return tmp_path


@pytest.mark.parametrize(
    ("patterns", "names"),
    [
        (["**/*.csv"], ["v1/s1/20260102.csv", "v1/s1/b.csv", "v2/s[2]/a.csv"]),
        (["v2"], ["v2/s[2]/a.csv"]),
        (["v2/s[2]/a.csv"], ["v2/s[2]/a.csv"]),
        (["v1/*/b.csv", "v1/s1/?.csv"], ["v1/s1/b.csv"]),
    ],
)
def test_patterns(folder, patterns, names):
    assert [log.place for log in found(patterns)] == names


def test_the_results_are_no_logs(folder):
    assert [log.place for log in found(["."], "v1")] == ["v2/s[2]/a.csv"]
    with pytest.raises(UsageError, match="--output"):
        found(["v1/s1/b.csv"], "v1")


def test_a_log_that_changes_has_another_tag(folder):
    before = found(["v1/s1/b.csv"])[0]
    Path("v1/s1/b.csv").write_text("v1/s1/c.csv")
    assert found(["v1/s1/b.csv"])[0].tag != before.tag


def log(place, size=1):
    return Listed(place, size, place)


def test_a_group_states_whose_a_log_is():
    rule = ByGroup(GROUP)
    assert rule.of(log("logs/v1/s1/20260102.csv")) == Identity("v1", "s1", date=1_767_312_000 * 10**9)
    assert rule.of(log("a.csv")) == NOBODY
    for text in ("(", "(?P<who>.)", "."):
        with pytest.raises(UsageError):
            ByGroup(text)


@pytest.mark.parametrize(
    ("text", "seconds"),
    [("2026-01-02", 0), ("20260102_0304", 11040), ("2026-01-02T00:00:01Z", 1), ("2026-01-02T01:00+01:00", 0)],
)
def test_dates(text, seconds):
    assert Identity.of({"date": text}).date == (1_767_312_000 + seconds) * 10**9


@pytest.mark.parametrize("text", ["spring", "31.12.2025", "2026-13-40", "0", "0001-01-01", "9999-12-31", "2026-02-30"])
def test_a_date_that_is_none_is_refused_with_its_log_or_row(tmp_path, text):
    with pytest.raises(UsageError, match=r"logs/0\.csv.*2026-01-02"):
        ByGroup(r"(?P<date>.*) logs").of(log(f"{text} logs/0.csv"))
    table = tmp_path / "who.csv"
    table.write_text(f"log,date\na.csv,2026-01-02\nb.csv,{text}\n")
    with pytest.raises(UsageError, match=r"row 3.*2026-01-02"):
        ByTable(table)


def test_a_table_states_whose_a_log_is(tmp_path):
    table = tmp_path / "who.csv"
    table.write_text("log,serial,vehicle\ns1/a.csv,A,\na.csv,B,v\n")
    rule = ByTable(table)
    assert rule.of(log("x/s1/a.csv")) == Identity(None, "A")
    assert rule.of(log("x/s2/a.csv")) == Identity("v", "B")
    assert rule.of(log("b.csv")) == NOBODY
    table.write_text("log,serial\na.csv,A\na.csv,B\n")
    with pytest.raises(UsageError, match=r"a\.csv"):
        ByTable(table)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("log,serial,serial\na.csv,A,B\n", ["several columns", "serial"]),
        ("log,serial,vehicle\nb.csv,B,v\na.csv,A\n", ["row 3", "2 fields", "3 columns"]),
        ("log,serial\na.csv,A,v\n", ["row 2", "3 fields"]),
        ("log,serial\n,A\n", ["row 2", "no log"]),
        ("log,serial\nlogs/a.csv,A\n./logs/a.csv,B\n", ["row 3", "logs/a.csv", "differs"]),
        ('log,serial\na.csv,"A\n', ["cannot be read"]),
        ("", ["columns are none"]),
    ],
)
def test_a_table_that_is_wrong_is_refused_with_the_row(tmp_path, text, words):
    table = tmp_path / "who.csv"
    table.write_text(text)
    with pytest.raises(UsageError) as refused:
        ByTable(table)
    assert all(word in str(refused.value) for word in words), refused.value


def test_a_row_names_one_log(tmp_path):
    table = tmp_path / "who.csv"
    table.write_text("log,serial\n0.csv,A\n")
    logs = [log("logs/a/0.csv"), log("logs/b/0.csv")]
    with pytest.raises(UsageError, match=r"row 2: 0\.csv fits 2 logs \(logs/a/0\.csv, logs/b/0\.csv\)"):
        planned(logs, ByTable(table), ())
    table.write_text("log,serial\n0.csv,A\nb/0.csv,B\n,\n")
    assert [task.identity.serial for task in planned(logs, ByTable(table), ())] == ["A", "B"]
    assert [task.identity.serial for task in planned(logs[:1], ByTable(table), ())] == ["A"]


@pytest.mark.parametrize(
    "form", ["./logs/x.csv", "logs//x.csv", "{}/logs/x.csv", "logs\\x.csv", "../{name}/logs/x.csv"]
)
def test_a_path_in_a_table_is_written_in_any_way(tmp_path, monkeypatch, form):
    monkeypatch.chdir(tmp_path)
    Path("who.csv").write_text(f"log,serial\n{form.format(tmp_path, name=tmp_path.name)},A\n")
    rule = ByTable(Path("who.csv"))
    assert rule.of(log("logs/x.csv")).serial == "A"
    assert rule.of(log(str(tmp_path / "logs" / "x.csv"))).serial == "A"
    assert rule.of(log("other/x.csv")) == NOBODY


def test_rows_of_no_log_are_counted(tmp_path):
    table = tmp_path / "who.csv"
    table.write_text("log,serial\na.csv,A\nb.csv,B\nc.csv,C\n")
    assert ByTable(table).unused([log("x/a.csv")]).startswith("2 of 3 rows of ")
    assert not ByTable(table).unused([log("a.csv"), log("b.csv"), log("x/c.csv")])


def test_a_log_states_whose_it_is(tmp_path):
    path = tmp_path / "a.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        writer.add_metadata("imu", {"serial": "S7"})
        writer.finish()
    assert stated(str(path)) == {"imu.serial": "S7"}
    assert ByMetadata("serial=imu.serial,vehicle=car").of(log(str(path))) == Identity(None, "S7")


def test_metadata_that_state_a_part_twice_are_refused():
    with pytest.raises(UsageError, match="twice"):
        ByMetadata("serial=a,serial=b")


def test_a_px4_log_states_its_messages(tmp_path):
    path, key, value = tmp_path / "a.ulg", b"char[3] sys_uuid", b"U-1"
    content = bytes([len(key)]) + key + value
    path.write_bytes(
        b"ULog\x01\x12\x35\x01" + bytes(8) + len(content).to_bytes(2, "little") + b"I" + content + bytes(3)
    )
    assert stated(str(path)) == {"sys_uuid": "U-1"}


def test_nothing_known_of_any_log_is_an_error():
    with pytest.raises(UsageError, match=r"a\.csv"):
        planned([log("a.csv")], ByGroup(GROUP), ())


def test_an_option_of_the_sensor_is_filled_and_a_part_of_the_task(tmp_path):
    rule, logs = ByGroup(GROUP), [log("v1/s1/a.csv"), log("v1/s2/a.csv")]
    values = [("parameters.error_model", tmp_path / "{serial}.toml")]
    first, second = planned(logs, rule, values)
    assert first.values == (("parameters.error_model", tmp_path / "s1.toml"),)
    (tmp_path / "s1.toml").write_text("new")
    changed, same = planned(logs, rule, values)
    assert (changed.tag != first.tag, same.tag == second.tag) == (True, True)
    assert planned([log("a.csv"), *logs], rule, values)[0].missing == "serial"


def test_each_sensor_is_seen_early():
    sizes = np.random.default_rng(1).integers(1, 1000, 30)
    tasks = planned([log(f"v/s{i % 3}/{i}.csv", int(size)) for i, size in enumerate(sizes)], ByGroup(GROUP), ())
    first = ordered(tasks)[:3]
    assert {task.identity.serial for task in first} == {"s0", "s1", "s2"}
    assert [task.log.size for task in first] == [min(sizes[i::3]) for i in range(3)]
    assert len(ordered(tasks)) == 30

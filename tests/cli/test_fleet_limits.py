"""imuwb fleet and its report where the tables have limits only, or no intervals: what is said, what is suggested, and the sheet."""

import json
import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pyarrow.parquet as pq
import pytest

from imuwb.cli.fleet.panel import answer_of
from imuwb.fleet.report.answer import answer
from imuwb.fleet.report.result import fleet_report
from imuwb.fleet.report.sheet import FAMILY, SheetVerdict
from imuwb.fleet.run_state import run_state
from imuwb.fleet.store import store_at
from imuwb.statistics import Coefficient
from imuwb.stochastic.model_check import Limit, verdict
from tests.fleet_results import rows_of, tables_of, write

FEW = {"sensors": 6, "logs": 3, "planted": False, "outages": False, "damaged": 0}


def limits_only(rows):
    """Make each value a limit at its upper end."""
    for row in rows["sensors"]:
        row.update(value=None, lower=None)
    return rows


def without_intervals(rows):
    for row in rows["sensors"]:
        row.update(lower=None, upper=None)
    return rows


def without_rows(rows):
    return {**rows, "sensors": []}


def without_headlines(rows):
    for row in rows["sensors"]:
        row["headline"] = False
    return rows


def quarantined(rows):
    for row in rows["logs"]:
        row["state"] = "quarantined"
    return {**rows, "sensors": []}


def doubtful(rows):
    for row in rows["sensors"]:
        row.update(verdict="suspicious", remarks="SUSPICIOUS: moving")
    return rows


@pytest.mark.parametrize(
    ("made", "said", "unsaid"),
    [
        (limits_only, ["a limit only", "--check"], ["--with-doubtful", "quarantine"]),
        (without_intervals, ["there is no interval", "imuwb fleet noise"], ["--with-doubtful", "quarantine"]),
        (without_rows, ["none of the 18 logs", "noise states none"], ["quarantine", "--with-doubtful"]),
        (without_headlines, ["none of the 18 logs", "headline"], ["quarantine", "--with-doubtful", "states none"]),
        (quarantined, ["none of the 18 logs", "quarantine.parquet"], ["imuwb fleet noise", "--with-doubtful"]),
        (doubtful, ["in doubt", "--with-doubtful"], ["--check", "imuwb fleet noise"]),
    ],
)
def test_each_case_without_a_family_has_its_sentence(imuwb, tmp_path, made, said, unsaid):
    done = imuwb("fleet", "report", write(tmp_path / "results", made(rows_of(**FEW))))
    assert done.code == 3
    assert all(text in done.err for text in said), done.err
    assert not any(text in done.err for text in unsaid), done.err


def test_a_run_without_a_family_that_has_not_ended_says_so(imuwb, tmp_path):
    none = {name: [] for name in rows_of(**FEW)}
    for rows, count in ((none, 0), (limits_only(rows_of(**FEW)), 18)):
        folder = write(tmp_path / f"results {count}", rows, state="interrupted", logs=300)
        done = imuwb("fleet", "report", folder)
        assert (done.code, f"{count} of 300 logs are in the tables" in done.err) == (3, True), done.err
        assert "all are in quarantine" not in done.err


@pytest.mark.parametrize(
    ("made", "suggested"),
    [(dict, True), (limits_only, False), (without_intervals, False), (without_rows, False), (without_headlines, False)],
)
def test_a_report_is_suggested_only_where_it_has_something_to_compare(tmp_path, made, suggested):
    store = store_at(str(write(tmp_path / "results", made(rows_of(**FEW)))))
    said = answer_of(run_state(store, ""), store, "results", 1)
    assert [step.command for step in said.next] == ["imuwb fleet report results"] * suggested
    assert any("no family to judge" in one for one in said.sentences) is not suggested


@pytest.mark.parametrize(("at_most", "code", "outcome"), [("0.5 deg/√h", 0, "within"), ("0.01 deg/√h", 1, "not sure")])
def test_limits_of_logs_can_keep_a_sheet(imuwb, tmp_path, at_most, code, outcome):
    folder = write(tmp_path / "results", limits_only(rows_of(**FEW)))
    (tmp_path / "sheet.toml").write_text(f'[gyro_x]\nN = "{at_most}"\n', "utf-8")
    done = imuwb("fleet", "report", folder, "--check", "sheet.toml", "--json", "-", "--html", "fleet.html")
    assert done.code == code, done.err
    result = json.loads(done.out)["result"]
    assert {one["outcome"] for one in result["verdicts"]} == {outcome}
    assert (len(result["verdicts"]), result["families"]) == (6, [])
    assert "No family is judged" in done.err
    assert "outcome" not in done.err
    (tmp_path / "other.toml").write_text('[gyro_z]\nN = "1 deg/√h"\n', "utf-8")
    assert imuwb("fleet", "report", folder, "--check", "other.toml", "--force").code == 1


def test_a_value_among_limits_is_held_against_the_sheet(imuwb, tmp_path):
    rows = rows_of(**FEW)
    kept = next(
        row for row in rows["sensors"] if (row["axis"], row["coefficient"]) == ("gyro_x", "N") and row["headline"]
    )
    value = kept["value"], kept["lower"]
    limits_only(rows)
    kept["value"], kept["lower"] = value
    (tmp_path / "sheet.toml").write_text('[gyro_x]\nN = "0.01 deg/√h"\n', "utf-8")
    done = imuwb("fleet", "report", write(tmp_path / "results", rows), "--check", "sheet.toml", "--json", "-")
    outcomes = {one["sensor"]: one["outcome"] for one in json.loads(done.out)["result"]["verdicts"]}
    assert (done.code, outcomes["SN000"], outcomes["SN001"]) == (1, "beyond", "not sure"), done.err


def test_one_of_a_kind_is_in_the_singular():
    state = SimpleNamespace(analysis="noise", command="", state="ended", logs=4)
    found = fleet_report(state, tables_of(rows_of(**FEW | {"sensors": 1, "logs": 4, "outages": True})))
    one = verdict(Limit("gyro_x", "N", 1e-9), Coefficient(1.0, 0.9, 1.1))
    said = " ".join(answer(found, [SheetVerdict("a", "S", one), SheetVerdict("a", FAMILY, one)]).sentences)
    assert "Family of 1 sensor," in said
    assert "1 sensor is beyond one" in said
    assert "differ by —" not in said


def test_differences_and_limits_of_the_json_have_a_unit(imuwb, tmp_path):
    rows = rows_of(sensors=20, damaged=0, logs=5)
    (tmp_path / "sheet.toml").write_text('[gyro_x]\nN = "0.3 deg/√h"\n', "utf-8")
    done = imuwb("fleet", "report", write(tmp_path / "results", rows), "--json", "-", "--check", "sheet.toml")
    result = json.loads(done.out)["result"]
    assert {one["size"]["unit"] for one in result["findings"]} == {"ln"}
    assert {one[name]["unit"] for one in result["families"] for name in ("between_sensors", "from_log_to_log")} == {
        "ln"
    }
    assert "ln/°C" in {one["per_degree"]["per_degree"]["unit"] for one in result["families"] if one["per_degree"]}
    assert {one["unit"] for one in result["verdicts"]} == {"rad/s/√Hz"}


@pytest.mark.parametrize(("state", "said"), [("ended", "of another run"), ("running", "being written")])
@pytest.mark.parametrize("table", ["sensors", "outages", "quarantine"])
def test_a_table_of_another_run_is_refused(imuwb, tmp_path, table, state, said):
    folder = write(tmp_path / "results", rows_of(**FEW), state=state)
    rows = rows_of(**FEW | {"sensors": 7, "outages": True, "damaged": 2})
    other = write(tmp_path / "other", rows)
    (folder / f"{table}.parquet").write_bytes((other / f"{table}.parquet").read_bytes())
    done = imuwb("fleet", "report", folder)
    assert (done.code, f"{table}.parquet" in done.err, said in done.err) == (2, True, True), done.err


@pytest.mark.skipif(sys.platform == "win32", reason="names of files have no controls there")
@pytest.mark.parametrize("name", ["n\x1bl", "it's\nx", "a\\b", "é \u202e"])
def test_the_path_of_a_log_can_be_opened_again(imuwb, tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    place = Path("logs", name, "0.csv")
    place.parent.mkdir(parents=True)
    place.write_text("no log")
    done = imuwb("fleet", "noise", "logs", "-o", "results", "--workers", "0")
    assert (done.code, "\x1b" in done.err) == (4, False)
    (path,) = pq.read_table("results/logs.parquet")["path"].to_pylist()
    assert Path(path).read_text() == "no log"
    rows = rows_of(**FEW)
    for row in rows["logs"]:
        row["path"] = path
    see = fleet_report(SimpleNamespace(analysis="noise", command="", state="ended", logs=18), tables_of(rows)).see(
        "sha256:00000000"
    )
    assert see.isprintable()
    shell = [shutil.which("bash") or pytest.skip("there is no bash"), "-c"]
    word = subprocess.run([*shell, f"printf %s {see.removeprefix('imuwb noise ')}"], capture_output=True, check=True)
    assert word.stdout.decode() == path

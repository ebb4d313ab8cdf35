"""imuwb fleet report: planted sensors are found and no other, in the panel, the recording, the page and JSON; bad input in plain sentences."""

import json
import math
import re
from dataclasses import replace

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from imuwb.fleet.progress import quarantined_text
from imuwb.fleet.report.answer import answer
from imuwb.fleet.report.groups import sensor_groups
from imuwb.fleet.report.outages import DRIFT, RATIO
from imuwb.fleet.report.result import fleet_report
from imuwb.fleet.run_state import run_state
from imuwb.fleet.store import store_at
from imuwb.review.page.catalog import entries
from tests.fleet_results import DRIFTING, OUT, TRUTH, rows_of, tables_of, write

FEW = {"sensors": 6, "logs": 3, "planted": False, "outages": False, "damaged": 0}
SHEET = '[gyro]\nN = "0.3 deg/√h"\nK = "10 deg/h^1.5"\n[accel_z]\nK = "10 m/s/h^1.5"\n'


@pytest.fixture(scope="module")
def planted(tmp_path_factory):
    return write(tmp_path_factory.mktemp("fleet") / "results", rows_of(nu=(20000.0, 10.0)))


def report_of(folder_or_rows, **options):
    rows = folder_or_rows
    state = run_state(store_at(str(rows)), "") if not isinstance(rows, dict) else None
    if state is None:
        state = type("State", (), {"analysis": "noise", "command": "", "state": "ended", "logs": 1})()
        return fleet_report(state, tables_of(rows), **options)
    tables = {name: pq.read_table(rows / f"{name}.parquet") for name in ("logs", "sensors", "outages", "quarantine")}
    return fleet_report(state, tables, **options)


def test_the_planted_sensors_are_found_and_no_other(planted):
    found = report_of(planted)
    noise = [one for one in found.findings if found.groups[one.group].axis]
    assert {one.sensor for one in noise if one.kind == "out of family"} == set(OUT)
    assert {(one.sensor, one.kind) for one in noise if one.kind != "out of family"} == {(DRIFTING, "drifts")}
    assert all(found.groups[one.group].name in ("gyro x N", "gyro y N") for one in noise)
    for group, own in zip(found.groups, found.judged, strict=True):
        if group.axis:
            truth = group.display.to_si(TRUTH[group.axis.partition("_")[0], group.coefficient])
            assert own.mean.value == pytest.approx(math.log(truth), abs=0.05), group.name
    others = [one for one in found.findings if one not in noise]
    assert {(one.sensor, one.kind, found.groups[one.group].coefficient) for one in others} == {
        ("V15", "out of family", DRIFT)
    }
    drift = next(j for g, j in zip(found.groups, found.judged, strict=True) if g.coefficient == DRIFT)
    ratios = {g.source: j.mean.value for g, j in zip(found.groups, found.judged, strict=True) if g.coefficient == RATIO}
    assert drift.sensors.sensor.size == 20
    assert ratios["full, 60 s"] == pytest.approx(0, abs=0.05)
    assert ratios["15AV, 60 s"] == pytest.approx(0.693, abs=0.05)


def test_panel_recording_page_json_and_exit_code(imuwb, planted, tmp_path):
    (tmp_path / "sheet.toml").write_text(SHEET, "utf-8")
    done = imuwb(
        "fleet", "report", planted, "-o", "fleet.rrd", "--html", "fleet.html", "--json", "fleet.json", "--check", "sheet.toml",
        "--max-quarantine", "1%",
    )  # fmt: skip
    lines = done.out.splitlines()
    assert len(lines) <= 15
    assert all(len(line) <= 80 for line in lines)
    assert {line.split()[0] for line in lines if "out of family" in line[:30]} == {*OUT, "V15"}
    assert re.search(rf"{DRIFTING} +drifts +gyro .*in 4 months", done.out)
    assert "18 of 218 logs (8.3 %)" in done.out
    assert "imuwb noise 'logs/SN" in done.out
    assert done.code == 1
    assert "beyond" in done.err
    assert "--max-quarantine allows 1 %" in done.err
    content = json.loads((tmp_path / "fleet.json").read_text("utf-8"))["result"]
    assert {one["sensor"] for one in content["findings"] if one["finding"] == "out of family"} == {*OUT, "V15"}
    assert content["findings"][0]["logs"][0]["see"].startswith("imuwb noise ")
    outcomes = {
        (one["axis"], one["coefficient"], one["outcome"]) for one in content["verdicts"] if one["sensor"] == "SN039"
    }
    assert ("gyro_x", "N", "beyond") in outcomes
    assert ("accel_z", "K", "within") in outcomes
    assert {one["outcome"] for one in content["verdicts"] if (one["axis"], one["coefficient"]) == ("gyro_x", "K")} == {
        "not known"
    }
    page = (tmp_path / "fleet.html").read_text("utf-8")
    assert all(f"{name} out of family" in page for name in OUT)
    assert "damaged 3.mcap" in page
    (row,) = entries(tmp_path, tmp_path / "index.html")
    figures = dict(row.figures)
    assert (figures["out of family"], figures["changing"], figures["quarantined logs"]) == ("3", "1", "18")
    assert "ICM-20948 gyro x N [deg/√h]" in figures


def test_a_fleet_without_any_has_no_finding_and_keeps_its_limits(imuwb, tmp_path):
    folder = write(tmp_path / "results", rows_of(**FEW))
    (tmp_path / "sheet.toml").write_text('[gyro_x]\nN = "0.4 deg/√h"\n', "utf-8")
    done = imuwb("fleet", "report", folder, "--check", "sheet.toml", "--max-quarantine", "0%", "--json", "-")
    assert done.code == 0, done.err
    assert json.loads(done.out)["result"]["findings"] == []
    assert "chance alone finds one in 1 % of" in done.err
    assert "With so few sensors only a far one is found: gyro" in done.err
    assert (folder / "report.rrd").is_file()


def test_a_sensor_far_outside_is_found_among_six_and_four_are_too_few(imuwb, tmp_path):
    rows = rows_of(**FEW)
    for row in rows["sensors"]:
        if (row["serial"], row["coefficient"]) == ("SN003", "N"):
            row.update({name: 2.5 * row[name] for name in ("value", "lower", "upper")})
    done = imuwb("fleet", "report", write(tmp_path / "six", rows), "--json", "-")
    found = json.loads(done.out)["result"]["findings"]
    assert {(one["sensor"], one["finding"], one["coefficient"]) for one in found} == {("SN003", "out of family", "N")}
    done = imuwb("fleet", "report", write(tmp_path / "four", rows_of(**{**FEW, "sensors": 4})), "--json", "-")
    assert "cannot be said: that needs 5 sensors" in " ".join(done.err.split())
    assert {tuple(one["out_of_family_beyond"]) for one in json.loads(done.out)["result"]["families"]} == {(None, None)}


def test_a_sensor_whose_logs_give_limits_far_below_the_family_is_found_and_shown(imuwb, tmp_path):
    rows = rows_of(sensors=20, planted=False, outages=False, damaged=0)
    for row in rows["sensors"]:
        if (row["serial"], row["axis"], row["coefficient"]) == ("SN005", "gyro_x", "N"):
            row.update(value=None, lower=None, upper=0.2 * row["value"])
        if (row["serial"], row["axis"], row["coefficient"], row["log"][-1]) == ("SN007", "gyro_y", "N", "2"):
            row.update(value=None, lower=None, upper=0.2 * row["value"])
    folder = write(tmp_path / "results", rows)
    done = imuwb("fleet", "report", folder, "--json", "-", "--html", tmp_path / "page.html")
    result = json.loads(done.out)["result"]
    (found,) = result["findings"]
    assert (found["sensor"], found["finding"], found["axis"]) == ("SN005", "out of family", "gyro_x")
    assert found["size"]["lower"] is None
    assert "below 2" in done.err.splitlines()[2]
    families = {(one["axis"], one["coefficient"]): one for one in result["families"]}
    assert families["gyro_x", "N"]["limited_logs"] == 5
    assert families["gyro_y", "N"]["limits_that_values_contradict"] == 1
    assert families["gyro_x", "N"]["between_sensors"]["value"] < 0.08
    assert "limit is far below" in " ".join(done.err.split())
    assert "&lt; " in (tmp_path / "page.html").read_text("utf-8")


def test_the_mean_of_a_sensor_that_steps_has_the_interval_of_its_logs():
    rows = rows_of(sensors=20, planted=False, outages=False, damaged=0)
    for row in rows["sensors"]:
        if (row["serial"], row["axis"], row["coefficient"]) == ("SN004", "gyro_x", "N") and row["log"][-1] in "34":
            row.update({name: 3.0 * row[name] for name in ("value", "lower", "upper")})
    found = {one.kind: one for one in report_of(rows).findings}
    assert set(found) == {"steps", "out of family"}
    assert math.log(3) in found["steps"].size
    assert found["out of family"].size.lower < 0 < math.log(3) < found["out of family"].size.upper


def test_copies_are_no_worthless_logs():
    rows = rows_of(**FEW)
    rows["quarantine"] += [
        {"path": f"logs/copy{n}.mcap", "log": f"sha256:0000000{n}", "vehicle": "V00", "serial": "SN000", "family": None, "stage": "triage",
         "kind": "duplicate", "message": "it has the same bytes"} for n in range(2)
    ]  # fmt: skip
    found = report_of(rows)
    assert (found.copies, found.quarantined, found.quarantined_share, found.kinds.total()) == (2, 0, 0.0, 0)
    said = " ".join(answer(found).sentences)
    assert "2 logs with the bytes of another" in said
    assert "Worthless" not in said


def test_a_third_of_a_family_far_outside_is_found_and_more_may_be():
    rows = rows_of(sensors=20, planted=False, outages=False, damaged=0)
    bad = {f"SN{number:03d}" for number in range(6)}
    for row in rows["sensors"]:
        if row["serial"] in bad and row["coefficient"] == "N":
            row.update({name: 2.5 * row[name] for name in ("value", "lower", "upper")})
    found = report_of(rows)
    assert {one.sensor for one in found.findings if one.kind == "out of family"} == bad
    assert max(one.probability for one in found.findings) < 0.01
    assert "More sensors may be out of family" in answer(found).sentences[0]


def test_what_is_not_counted_is_said():
    rows = rows_of(**FEW)
    for row in rows["sensors"]:
        if row["log"] == "sha256:00000000":
            row["verdict"], row["remarks"] = "suspicious", "suspicious: moving"
        if row["log"] == "sha256:00010000":
            row["serial"] = row["vehicle"] = None
        if row["log"] == "sha256:00020000":
            row["lower"] = 0.0
    found = report_of(rows)
    group = next(group for group in found.groups if group.name == "gyro x N")
    assert sorted(group.left_out.values()) == [1, 1]
    assert (group.limited.upper.size, group.limited.share[0] > 0.9, group.limited.probability[0]) == (1, True, 0.975)
    said = answer(found).sentences
    assert "values are limits; they count as limits in the family" in said[-2]
    assert said[-1].startswith("Not counted: ")
    assert [one.kind for one in found.worthless] == ["suspicious"]
    kept = sensor_groups(tables_of(rows)["sensors"], doubtful=True)
    assert sum(next(g for g in kept if g.name == "gyro x N").left_out.values()) == 1


@pytest.mark.parametrize(
    ("rows", "options", "said"),
    [
        (FEW | {"sensors": 1, "logs": 4}, {}, " 1 sensor,"),
        (FEW | {"sensors": 8, "logs": 1}, {}, "Each has one log"),
    ],
)
def test_one_sensor_and_one_log_a_sensor_are_judged_as_far_as_they_go(rows, options, said):
    from imuwb.fleet.report.answer import answer
    from imuwb.fleet.report.show import family_table

    found = report_of(rows_of(**rows), **options)
    assert not found.findings
    text = f"{answer(found).about} {' '.join(answer(found).sentences)}"
    assert said in text
    assert "nan" not in text
    assert "inf" not in text
    assert not any("nan" in cell or "inf" in cell for row in family_table(found).rows for cell in row)


def test_hostile_names_are_shown_and_do_nothing(imuwb, tmp_path):
    hostile = "\x1b[2J<script>alert(1)</script>|`# \u202e"
    rows = rows_of(**FEW | {"planted": False, "damaged": 2})
    for table in rows.values():
        for row in table:
            for name in ("vehicle", "serial", "family", "stream", "message", "path", "remarks"):
                if row.get(name):
                    row[name] = f"{hostile}{row[name]}"
    done = imuwb("fleet", "report", write(tmp_path / "results", rows), "--full", "--html", "fleet.html")
    assert done.code == 0, done.err
    assert "\x1b" not in done.out + done.err
    assert "<script>alert" not in (tmp_path / "fleet.html").read_text("utf-8")


def spoiled(folder, how):
    if how == "empty":
        for path in folder.iterdir():
            path.unlink()
    elif how == "running":
        (folder / "sensors.parquet").unlink()
    elif how == "version":
        table = pq.read_table(folder / "sensors.parquet")
        pq.write_table(
            table.replace_schema_metadata({b"imuwb.table": b"sensors", b"imuwb.schema": b"99"}),
            folder / "sensors.parquet",
        )
    elif how == "columns":
        table = pq.read_table(folder / "sensors.parquet")
        pq.write_table(table.drop_columns(["upper"]), folder / "sensors.parquet")
    elif how == "damaged":
        (folder / "sensors.parquet").write_bytes(b"PAR1")
    elif how == "no rows":
        table = pq.read_table(folder / "sensors.parquet")
        pq.write_table(table.slice(0, 0), folder / "sensors.parquet")
    elif how == "unknown sensors":
        table = pq.read_table(folder / "sensors.parquet")
        for name in ("vehicle", "serial"):
            place = table.schema.get_field_index(name)
            table = table.set_column(place, table.schema.field(name), pa.nulls(table.num_rows, pa.string()))
        pq.write_table(table, folder / "sensors.parquet")
    return folder


@pytest.mark.parametrize(
    ("how", "code", "said"),
    [
        ("empty", 2, "no run.json"), ("running", 3, "sensors.parquet: not there"), ("version", 2, "schema 99"), ("columns", 2, "upper"),
        ("damaged", 2, "no table 'sensors'"), ("no rows", 3, "none of the 18 logs"), ("unknown sensors", 3, "--group"),
    ],
)  # fmt: skip
def test_bad_results_are_refused_in_a_sentence(imuwb, tmp_path, how, code, said):
    folder = spoiled(write(tmp_path / "results", rows_of(**FEW)), how)
    done = imuwb("fleet", "report", folder)
    assert (done.code, said in done.err) == (code, True), done.err
    assert not (folder / "report.rrd").exists()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--max-quarantine", "1"), "such as 1%"), (("--error", "0"), "--error is 0"), (("--level", "95"), "--level is 95"),
        (("-o", "fleet.html"), "must end in .rrd"), (("--check", "none.toml"), "none.toml"),
    ],
)  # fmt: skip
def test_wrong_options_are_refused(imuwb, tmp_path, options, said):
    done = imuwb("fleet", "report", write(tmp_path / "results", rows_of(**FEW)), *options)
    assert done.code in (2, 4)
    assert said in done.err


def test_heavy_tails_between_sensors_are_said_where_they_are_sure():
    found = report_of(rows_of(**FEW))
    assert found.tails is None
    heavy = replace(found, judged=(*found.judged[:-1], replace(found.judged[-1], tails=0.0)))
    name = found.groups[-1].name
    assert any(f"in {name} with heavier tails than normal ones" in one for one in answer(heavy).sentences)
    assert ["more than 1 %" in answer(one).sentences[0] for one in (found, heavy)] == [False, True]
    unsure = replace(found, judged=tuple(replace(one, tails=0.5) for one in found.judged))
    assert not any("heavier tails" in one for one in answer(unsure).sentences)


def test_one_log_is_in_quarantine_and_two_are(imuwb, tmp_path):
    folder = write(tmp_path / "results", rows_of(**FEW | {"damaged": 1}))
    done = imuwb("fleet", "report", folder, "--max-quarantine", "0%")
    assert (done.code, "1 of 19 logs is in quarantine (5.26 %), and" in done.err) == (1, True), done.err
    assert quarantined_text(1) == "1 is in quarantine"
    assert quarantined_text(2) == "2 are in quarantine"


@pytest.mark.parametrize("state", ["interrupted", "running"])
def test_a_run_that_has_not_ended_says_so_and_passes_no_gate(imuwb, tmp_path, state):
    folder = write(tmp_path / "results", rows_of(**FEW | {"damaged": 2}), state=state, logs=300, quarantined=0)
    done = imuwb("fleet", "report", folder, "--json", "fleet.json", "--html", "fleet.html")
    assert (done.code, "20 of 300 logs of 6 sensors" in done.out) == (0, True), done.err
    content = json.loads((tmp_path / "fleet.json").read_text("utf-8"))["result"]
    assert (content["state"], content["logs"], content["logs_of_run"]) == (state, 20, 300)
    assert "20 of 300 logs are in the tables" in (tmp_path / "fleet.html").read_text("utf-8")
    done = imuwb("fleet", "report", folder, "--max-quarantine", "5%", "--force")
    assert (done.code, "2 of 20 logs are in quarantine (10 %)" in done.err) == (1, True), done.err
    (tmp_path / "sheet.toml").write_text('[gyro_x]\nN = "9 deg/√h"\n', "utf-8")
    for limit in (("--max-quarantine", "50%"), ("--check", "sheet.toml")):
        done = imuwb("fleet", "report", folder, *limit, "--force")
        assert (done.code, f"{'interrupted' if state == 'interrupted' else 'under way'}" in done.err) == (1, True)


def test_a_serial_in_two_vehicles_is_one_sensor_and_is_said(imuwb, tmp_path):
    rows = rows_of(**FEW | {"sensors": 5})
    for table in rows.values():
        for row in table:
            row["serial"] = "SN000" if row["serial"] == "SN001" else row["serial"]
            row["vehicle"] = {"SN000": row["log"][-1:]}.get(row["serial"], row["vehicle"])
    found = report_of(rows)
    assert (found.sensors, found.owned.sensors, found.owned.moved[0][1]) == (4, 4, ("0", "1", "2"))
    done = imuwb("fleet", "report", write(tmp_path / "results", rows))
    assert "15 logs of 4 sensors" in done.out
    assert "Serial SN000 is in 3 vehicles" in done.out


@pytest.mark.parametrize(
    "name", ["run.json", "progress.jsonl", "logs.parquet", "parts/r/00/x.json", "../results/run.json", "../sheet.toml"]
)
def test_no_output_replaces_a_file_of_the_run_or_the_sheet(imuwb, tmp_path, name):
    folder = write(tmp_path / "results", rows_of(**FEW))
    (folder / "parts" / "r" / "00").mkdir(parents=True)
    (tmp_path / "sheet.toml").write_text(SHEET, "utf-8")
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    done = imuwb("fleet", "report", folder, "--force", "--check", "sheet.toml", "--json", folder / name)
    assert (done.code, name.rpartition("/")[2] in done.err) == (2, True), done.err
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before


def test_a_file_of_that_name_elsewhere_is_replaced(imuwb, tmp_path):
    folder = write(tmp_path / "results", rows_of(**FEW))
    for _ in range(2):
        done = imuwb("fleet", "report", folder, "--force", "--json", "run.json")
        assert done.code == 0, done.err


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"schema": 2}, "schema 2"),
        ({"logs": "many"}, "damaged"),
        ({"state": "odd"}, "damaged"),
        ({"params": 1}, "damaged"),
    ],
)
def test_bad_states_of_a_run_are_refused_without_an_option_that_does_not_help(imuwb, tmp_path, changed, said):
    folder = write(tmp_path / "results", rows_of(**FEW), **changed)
    done = imuwb("fleet", "report", folder)
    assert (done.code, said in done.err, "run the fleet again" in done.err) == (2, True, True), done.err
    assert "--force" not in done.err.replace("imuwb fleet ANALYSIS LOGS --force", "")


def test_vehicles_are_not_called_sensors():
    rows = rows_of(**FEW)
    for table in rows.values():
        for row in table:
            row["serial"] = None
    assert "18 logs of 3 vehicles, whose sensors are not named" in answer(report_of(rows)).about

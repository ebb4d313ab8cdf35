"""``imuwb info``: the streams of a log, its faults, and when a log is read as a whole."""

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from mcap.writer import Writer

from imuwb import health
from imuwb.cli import info
from imuwb.health import Fault
from imuwb.log import SECOND, GnssStream, ImuStream, Log, Orientation, Provenance, Triad
from imuwb.review.answers.log_answer import log_answer
from imuwb.review.answers.panel import HEIGHT, WIDTH, Origin, panel
from imuwb.review.tables.contents import can_be_used, contents_table, usable_table
from imuwb.summary import summarize
from imuwb.writers import write


def test_faults_are_counted_and_the_analysis_of_faults_is_named(imuwb, csv_log, rows):
    lines = rows()
    jumped = [f"{float(line.split(',')[0]) + 1.7e9:.2f},{line.partition(',')[2]}" for line in lines[50:]]
    shown = imuwb("info", csv_log([*lines[:50], *jumped])).out
    assert "53.9 years" in shown
    assert "imuwb health" in shown
    assert "fault" in shown.splitlines()[-1] + shown.splitlines()[-2]


def made(severity, stream="imu", what="gap"):
    return Fault(stream, what, what, severity)


def test_notes_are_not_counted_as_faults(imuwb, static_mcap, monkeypatch):
    def shown(*severities):
        faults = [made(severity) for severity in severities]
        monkeypatch.setattr(health, "check", lambda *_, **__: SimpleNamespace(faults=faults))
        return imuwb("info", static_mcap).out

    assert "No fault" in shown("note")
    found = shown("fault", "warning", "note")
    assert "1 fault and 1 warning" in found
    assert "!! imu: gap" in found


@pytest.mark.parametrize(("arguments", "read"), [((), False), (("--scan",), True)])
def test_a_large_log_is_summarized_from_its_index(imuwb, static_mcap, monkeypatch, arguments, read):
    seen = []
    monkeypatch.setattr(info, "faults_of", lambda log: seen.append(log) or ())
    monkeypatch.setattr(info, "LARGE", static_mcap.stat().st_size - 1)
    shown = imuwb("info", static_mcap, *arguments)
    assert (shown.code, bool(seen), "--scan" in shown.out) == (0, read, not read)
    count = json.loads(imuwb("info", static_mcap, *arguments, "--json").out)["streams"][0]["count"]
    assert count == 3000


def test_logs_up_to_256_mib_are_read():
    assert info.LARGE == 268_435_456


HEADER = "time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2"


def csv_of(path, columns="", change=None):
    """Write a log of 500 rows; ``change`` may change the cells of each row, or return None to leave it out."""
    lines = [HEADER + columns]
    for k in range(500):
        cells = [f"{0.01 * k:.2f}", *(f"{0.01 * ((7 * k + 3 * i) % 11):.4f}" for i in range(5)), "-9.8"]
        cells = cells if change is None else change(k, cells)
        lines += [] if cells is None else [",".join(cells)]
    path.write_text("\n".join(lines) + "\n", "utf-8")
    return path


def test_what_can_be_used_comes_first_and_the_worst_fault_last(imuwb, tmp_path):
    path = csv_of(tmp_path / "log.csv", change=lambda k, cells: ["nan", *cells[1:]] if k % 40 == 0 else cells)
    done = imuwb("info", path)
    assert (done.code, done.err) == (0, "")
    lines = done.out.splitlines()
    assert len(lines) <= HEIGHT
    assert lines[0].startswith("LOG  log.csv: csv, ")
    assert lines[2].split()[:3] == ["noise,", "drift", "imu"]
    assert "13 times" in done.out
    assert "2.6 % of its rows" in " ".join(" ".join(lines[-2:]).split())


def test_everything_else_is_printed_when_it_is_asked_for(imuwb, static_mcap):
    done = imuwb("info", static_mcap, "--full")
    assert done.out.splitlines()[0].startswith("Can be used")
    assert "│ /imu/data (" in done.out
    assert "taken as the temperature" in done.err
    assert any(line.startswith("LOG  static.mcap") for line in done.out.splitlines())


@pytest.mark.parametrize("many", [True, False])
def test_a_log_of_many_streams_fits(many):
    summary = summarize(many_imus() if many else log_of())
    found = [made("fault", f"imu.{i}", f"fault{j} " + "long " * 20) for i in range(11) for j in range(9)]
    answer = log_answer(summary, None, found)
    lines = panel(answer, Origin("log", ("log.bin",)))
    assert len(lines) <= HEIGHT
    assert all(len(line) <= WIDTH for line in lines)
    assert "0-" in answer.rows[0][1]  # streams that are alike share a row
    assert sum(text.startswith("!!") for text in answer.sentences) > 2


def many_imus():
    """Return a log like an autopilot's: three IMUs, eight in batches, and one that is slow."""
    time = np.arange(2000) * (SECOND // 100)
    burst = np.concatenate([k * 20 * SECOND + np.arange(400) * (SECOND // 1000) for k in range(4)])
    slow = np.arange(40) * SECOND
    imus = [(f"IMU.{i}", time) for i in range(3)] + [(f"ISB.{i}", burst) for i in range(8)] + [("vehicle_imu.0", slow)]
    still = [
        ImuStream(name, *(Triad(t, np.random.default_rng(0).standard_normal((t.size, 3))),) * 2) for name, t in imus
    ]
    return Log(Provenance("made", "dataflash", "", 0), tuple(still))


def test_what_each_stream_can_be_used_for():
    rows = {row[1]: (row[0], row[4]) for row in log_answer(summarize(many_imus()), None, ()).rows}
    assert rows["IMU.0-2"] == ("noise, drift", "")
    assert rows["ISB.0-7"] == ("vibration", "in batches, 97 % missing")
    assert rows["vehicle_imu.0"] == ("—", "too slow")


@pytest.mark.parametrize("arguments", [(), ("--json",)])
def test_a_log_of_which_nothing_can_be_used_ends_with_3(imuwb, tmp_path, arguments):
    with (tmp_path / "talk.mcap").open("wb") as file:
        bag = Writer(file)
        bag.start("", "test")
        schema = bag.register_schema("Talk", "jsonschema", b"{}")
        channel = bag.register_channel("/talk", "json", schema)
        bag.add_message(channel, 0, b"{}", 0)
        bag.finish()
    done = imuwb("info", tmp_path / "talk.mcap", *arguments)
    assert done.code == 3
    assert "/talk" in (json.loads(done.out)["notes"][0] if arguments else done.err)
    assert "nothing in this file can be used" in done.err.splitlines()[-1]


def test_an_acceleration_without_gravity_is_named(imuwb, tmp_path):
    path = tmp_path / "log.mcap"
    write(log_of(force=np.random.default_rng(0).standard_normal((500, 3))), path)
    assert "gravity is missing" in " ".join(imuwb("info", path).out.split())


def log_of(force=None, **streams):
    time = np.arange(500) * (SECOND // 100)
    rate = Triad(time, np.random.default_rng(1).standard_normal((500, 3)))
    imus = tuple(
        ImuStream(f"/imu{k}", rate, Triad(time, rate.value - [0, 0, 9.8] if force is None else force)) for k in range(8)
    )
    return Log(Provenance("made", "mcap", "", 0), imus, **streams)


@pytest.mark.parametrize(
    ("velocity", "sigma", "says"),
    [(None, None, "no velocity, no position sigmas"), (1.0, None, "no position sigmas, no velocity sigmas"),
     (1.0, 1.0, "position, velocity, position sigmas, velocity sigmas")],
)  # fmt: skip
def test_what_a_receiver_does_not_state_is_said(velocity, sigma, says):
    time = np.arange(50) * SECOND
    full = [None if x is None else np.full((50, 3), x) for x in (velocity, sigma)]
    gnss = GnssStream("/fix", time, np.tile([0.8, 0.2, 0.0], (50, 1)), full[0], full[1], full[1])
    log = log_of(gnss=(gnss,))
    rows = dict(usable_table(summarize(log), log).rows)
    assert says in rows["receiver"]


def test_many_imus_that_are_alike_share_a_row():
    table = contents_table(summarize(log_of()))
    assert len(table.rows) == 1
    assert all(f"/imu{k}" in table.rows[0][0] for k in range(8))
    assert "gaps" not in table.headings


def test_columns_with_content_stay():
    log = log_of()
    keep = np.abs(np.arange(500) - 200) > 20
    cut = ImuStream("/cut", *(Triad(t.time[keep], t.value[keep]) for t in (log.imus[0].angular_rate,) * 2))
    table = contents_table(summarize(replace(log, imus=(*log.imus, cut))))
    assert [row[table.headings.index("gaps")].split(",")[0] for row in table.rows] == ["none", "1"]


def test_an_orientation_alone_is_nothing_to_use():
    time = np.arange(50) * SECOND
    orientation = Orientation("/imu", time, np.tile([1.0, 0, 0, 0], (50, 1)))
    assert not can_be_used(summarize(Log(Provenance("made", "mcap", "", 0), orientations=(orientation,))))
    assert can_be_used(summarize(log_of()))

"""Bad input of every kind: a message with the figures, the right exit code, no unfinished file, and no traceback."""

import gzip
import json
import os
import re
import sys

import numpy as np
import pytest

PNG = bytes.fromhex("89504e470d0a1a0a0000000d49484452000000010000000108060000001f15c489")


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("gone.mcap", None, "no such file"),
        ("empty.csv", b"", "empty"),
        ("picture.mcap", PNG, "an image"),
        ("words.csv", b"the quick brown fox 1\njumps over\n", "rows of numbers"),
        ("magic.mcap", b"\x89MCAP0\r\n", "no message can be read"),
    ],
)
def test_files_that_are_no_logs(imuwb, tmp_path, name, content, message):
    if content is not None:
        (tmp_path / name).write_bytes(content)
    for command in ("info", "allan"):
        done = imuwb(command, name)
        assert done.code == 4
        assert message in done.err
        assert name in done.err
    assert not list(tmp_path.glob("*.rrd"))


@pytest.mark.slow
def test_a_shell_sees_the_exit_code_and_the_message(process):
    done = process("allan", "gone.mcap")
    assert done.code == 4
    assert re.fullmatch(r"imuwb: gone\.mcap: .*no such file", done.err.strip())
    assert done.out == ""


def test_a_directory(imuwb, tmp_path):
    (tmp_path / "folder").mkdir()
    done = imuwb("allan", "folder")
    assert (done.code, "directory" in done.err) == (4, True)


@pytest.mark.slow
def test_a_truncated_mcap_is_used_as_far_as_it_is_whole(imuwb, static_mcap):
    whole = static_mcap.read_bytes()
    static_mcap.write_bytes(whole[: int(len(whole) * 0.6)])
    done = imuwb("info", static_mcap, "--json")
    assert done.code == 0
    document = json.loads(done.out)
    assert 500 < document["streams"][0]["count"] < 3000
    assert any("without its end mark" in note for note in document["notes"])
    assert imuwb("allan", static_mcap).code == 0


def repairs(done):
    return {r["what"]: r["count"] for s in json.loads(done.out)["streams"] for r in s["repairs"]}


def test_a_cut_last_line_is_left_out(imuwb, csv_log, rows):
    path = csv_log(rows())
    path.write_text(path.read_text().rstrip("\n")[:-7])
    done = imuwb("info", path, "--json")
    assert json.loads(done.out)["streams"][0]["count"] == 399
    assert any("cut" in what for what in repairs(done))


def test_text_in_a_number_column_costs_its_row(imuwb, csv_log, rows):
    lines = rows()
    lines[200] = lines[200].replace(lines[200].split(",")[2], "oops")
    done = imuwb("info", csv_log(lines), "--json")
    assert done.code == 0
    assert json.loads(done.out)["streams"][0]["count"] == 399
    assert repairs(done)["cells that are not numbers are taken as missing"] == 1


@pytest.mark.slow
def test_nan_costs_its_row(imuwb, csv_log, rows):
    lines = rows()
    lines[10] = lines[10].rpartition(",")[0] + ",nan"
    done = imuwb("info", csv_log(lines), "--json")
    assert json.loads(done.out)["streams"][0]["count"] == 399
    assert repairs(done)["rows with a value that is not a number left out"] == 1


def test_rows_out_of_order_are_sorted_and_repeats_left_out(imuwb, csv_log, rows):
    lines = rows()
    lines[50], lines[51] = lines[51], lines[50]
    lines.insert(100, lines[99])
    done = imuwb("info", csv_log(lines), "--json")
    assert json.loads(done.out)["streams"][0]["count"] == 400
    found = repairs(done)
    assert found["rows out of order sorted by time"] >= 1
    assert found["rows that repeat the row before, time and values, left out"] == 1


@pytest.mark.slow
def test_constant_channels(imuwb, csv_log, rows):
    stuck = [",".join([*line.split(",")[:1], "0.5", *line.split(",")[2:]]) for line in rows()]
    done = imuwb("allan", csv_log(stuck), "--json", "-")
    assert done.code == 0
    document = json.loads(done.out)
    axis = document["result"]["axes"]["gyro_x"]
    assert all(c["value"] is None for c in axis["coefficients"].values())
    assert any("gyro_x" in note and "constant" in note for note in document["notes"])
    assert document["result"]["axes"]["gyro_y"]["coefficients"]["N"]["value"] > 0
    dead = [line.split(",")[0] + ",0,0,0,0,0,-9.8" for line in rows()]
    done = imuwb("allan", csv_log(dead, "dead.csv"))
    assert (done.code, "constant" in done.err) == (3, True)


def test_a_wrong_unit_is_refused_with_the_likely_one(imuwb, csv_log, rows):
    lines = [line.replace(line.split(",")[-1], f"{float(line.split(',')[-1]) / 9.8:.5f}") for line in rows()]
    done = imuwb("allan", csv_log(lines))
    assert done.code == 4
    assert "likely g" in done.err
    assert "--units accel=g" in done.err


@pytest.mark.slow
def test_no_rate_where_none_can_be_known(imuwb, csv_log, rows):
    lines = [line.partition(",")[2] for line in rows()]
    path = csv_log(lines, header="gx_deg_s,gy_deg_s,gz_deg_s,ax_m_s2,ay_m_s2,az_m_s2")
    done = imuwb("allan", path)
    assert (done.code, "--rate" in done.err) == (2, True)
    assert imuwb("allan", path, "--rate", "100").code == 0


def test_ten_samples(imuwb, csv_log, rows):
    done = imuwb("allan", csv_log(rows(10)))
    assert (done.code, "10 samples" in done.err) == (3, True)


def test_no_imu_in_the_log(imuwb, tmp_path):
    (tmp_path / "fix.csv").write_text("time_s,lat,lon,alt\n" + "".join(f"{i},48.1,11.5,500\n" for i in range(200)))
    done = imuwb("allan", "fix.csv")
    assert (done.code, "IMU" in done.err) == (3, True)


def test_an_unknown_imu_lists_the_imus_of_the_log(imuwb, static_mcap):
    done = imuwb("allan", static_mcap, "--imu", "/imu/dat")
    assert (done.code, "/imu/data" in done.err) == (3, True)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32" or not hasattr(os, "geteuid"), reason="permissions are others there")
def test_unwritable_output(imuwb, static_mcap):
    done = imuwb("allan", static_mcap, "-o", "no/such/folder/x.rrd")
    assert (done.code, "cannot be written" in done.err) == (1, True)
    done = imuwb("allan", static_mcap, "-o", "/proc/x.rrd")
    assert (done.code, "cannot be written" in done.err) == (1, True)


def test_a_plugin_file_with_a_syntax_error(imuwb, static_mcap, tmp_path):
    (tmp_path / "bad.py").write_text("def run(:\n")
    done = imuwb("./bad.py", static_mcap)
    assert done.code == 2
    assert "line 1" in done.err
    (tmp_path / "lacks.py").write_text("x = 1\n")
    done = imuwb("./lacks.py", static_mcap)
    assert (done.code, "lacks Parameters, run, draw" in done.err) == (2, True)
    assert imuwb("./gone.py", static_mcap).code == 2


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--averaging-times", "octaves"], "log:90"),
        (["--averaging-times", "1e9"], "half the record"),
        (["--level", "95"], "below 1"),
        (["--start", "50", "--end", "10"], "must be after --start 50"),
        (["--start", "soon"], "ISO date"),
        (["--start", "1000"], "no IMU sample"),
        (["--units", "accel"], "--units"),
        (["--output", "x.mcap"], ".rrd"),
    ],
)
def test_wrong_options_are_explained(imuwb, static_mcap, arguments, message):
    done = imuwb("allan", static_mcap, *arguments)
    assert done.code in (2, 3)
    assert message in done.err


@pytest.mark.parametrize(
    "arguments",
    [["nonsense"], ["allan"], ["simulate", "static", "-o", "x.mcap"], ["simulate", "static", "--preset", "none", "-o", "x.mcap"],
     ["simulate", "static", "--preset", "mpu-6050", "-o", "x.txt"], ["simulate", "static", "--preset", "mpu-6050", "--hours", "-1", "-o", "x.mcap"]],
)  # fmt: skip
def test_wrong_usage(imuwb, arguments):
    done = imuwb(*arguments)
    assert done.code == 2
    assert done.err.strip()


def test_a_cut_gzip_file_is_used_as_far_as_it_unpacks(imuwb, csv_log, rows, tmp_path):
    packed = gzip.compress(csv_log(rows(4000)).read_bytes())
    (tmp_path / "log.csv.gz").write_bytes(packed[: len(packed) // 2])
    done = imuwb("info", "log.csv.gz", "--json")
    assert done.code == 0
    assert 500 < json.loads(done.out)["streams"][0]["count"] < 4000
    assert any("packed" in what for what in repairs(done))


@pytest.mark.slow
def test_a_curve_of_which_nothing_is_left_has_no_fit_and_no_crash(imuwb, shared, tmp_path):
    whole = (shared / "mcap" / "husky_test1_json.mcap").read_bytes()
    (tmp_path / "cut.mcap").write_bytes(whole[:582_492])
    done = imuwb("allan", "cut.mcap")
    assert done.code == 0
    assert "without its end mark" in done.out


def test_a_pipe_is_no_log_and_no_output(imuwb, tmp_path, static_mcap):
    if not hasattr(os, "mkfifo"):
        pytest.skip("this system has no named pipes")
    os.mkfifo(tmp_path / "pipe")
    done = imuwb("info", "pipe")
    assert (done.code, "a pipe" in done.err) == (4, True)
    done = imuwb("allan", static_mcap, "--json", "pipe", "--force")
    assert (done.code, "pipe: cannot be written" in done.err) == (1, True)


@pytest.mark.slow
def test_a_linked_output_stays_a_link(imuwb, tmp_path, static_mcap):
    (tmp_path / "target.json").write_text("old")
    (tmp_path / "link.json").symlink_to("target.json")
    assert imuwb("allan", static_mcap, "--json", "link.json", "--force").code == 0
    assert (tmp_path / "link.json").is_symlink()
    assert json.loads((tmp_path / "target.json").read_text("utf-8"))["analysis"] == "allan"


def test_damaged_bytes_in_a_line_of_another_length(imuwb, csv_log, rows, tmp_path):
    data = csv_log(rows()).read_bytes() + b"1,2,3,\xac\n"
    (tmp_path / "bad.csv").write_bytes(data)
    done = imuwb("info", "bad.csv", "--json")
    assert done.code == 0
    assert repairs(done)["lines without the usual number of cells left out"] == 1


def test_rows_in_no_order_are_sorted_not_stretched(imuwb, csv_log, rows):
    lines = [f"{20 * i}{line[line.index(',') :]}" for i, line in enumerate(rows())]
    np.random.default_rng(0).shuffle(lines)
    stream = json.loads(imuwb("info", csv_log(lines), "--json").out)["streams"][0]
    assert (stream["count"], stream["rate_hz"]) == (400, pytest.approx(0.05))


@pytest.mark.slow
def test_one_impossible_value_costs_its_axis(imuwb, csv_log, rows):
    lines = rows()
    lines[7] = ",".join(["0.07", "1e300", *lines[7].split(",")[2:]])
    document = json.loads(imuwb("allan", csv_log(lines), "--json", "-").out)
    assert any("gyro_x" in note and "1e+300" in note for note in document["notes"])
    assert document["result"]["axes"]["gyro_y"]["coefficients"]["N"]["value"] > 0


def test_an_ar_model_of_another_rate_is_wrong_usage(imuwb, tmp_path):
    (tmp_path / "m.toml").write_text(
        '[gyro_x]\nprocesses = [{process = "autoregressive", alpha = [0.5], beta0 = 1, dt = 0.02}]\n'
    )
    done = imuwb("simulate", "static", "--error-model", "m.toml", "--hours", "0.01", "-o", "x.csv")
    assert (done.code, "resample" in done.err) == (2, True)


def test_a_unit_that_is_none_is_wrong_usage_of_every_format(imuwb, static_mcap, csv_log, rows):
    for path in (static_mcap, csv_log(rows())):
        for units in ("gyro=furlong", "gyro=m", "colour=deg"):
            assert imuwb("info", path, "--units", units).code == 2


def test_options_that_a_format_does_not_use_are_named(imuwb, static_mcap, csv_log, rows):
    done = imuwb("info", static_mcap, "--units", "gyro=deg/s", "--rate", "5", "--columns", "a,b")
    assert done.code == 0
    assert "--columns, --units not used: a mcap log" in " ".join(done.out.split())
    assert "not used" not in imuwb("info", static_mcap, "--frame", "FLU").out
    assert "--time-source not used" in imuwb("info", csv_log(rows()), "--time-source", "log").out


def test_a_clock_that_jumps_by_decades_is_named(imuwb, csv_log, rows):
    lines = rows(2000)
    jumped = [f"{float(line.split(',')[0]) + 1.7e9:.2f},{line.partition(',')[2]}" for line in lines[50:]]
    path = csv_log([*lines[:50], *jumped])
    done = imuwb("health", path, "-o", "health.rrd", "--json", "-")
    assert done.code == 0, done.err
    worst = json.loads(done.out)["result"]["faults"][0]
    assert all(figure in worst["what"] for figure in ("clock jumps", "53.9 years", "50 rows", "1950"))
    assert "clock jumps" in imuwb("info", path).out


@pytest.mark.parametrize(
    ("content", "fault"),
    [
        (None, "a directory"),
        (b"", "the file is empty"),
        (b"hello", "not a Rerun recording"),
        (b"RRF2" + bytes(50), "cut or damaged"),
    ],
)
def test_view_states_the_fault_of_a_recording(imuwb, tmp_path, content, fault):
    path = tmp_path / "some.rrd"
    path.mkdir() if content is None else path.write_bytes(content)
    done = imuwb("view", path)
    assert done.code == 4
    assert fault in done.err


def test_help_of_an_analysis_names_all_formats(imuwb):
    shown = imuwb("health", "--help").out
    assert all(name in shown for name in ("MCAP", "bag", "db3", "tlog", "bin", "ulg", "CSV", "RTKLIB .pos"))


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="no limit on the size of files there")
def test_a_recording_that_does_not_fit_leaves_nothing(static_mcap, tmp_path):
    import resource
    import subprocess

    done = subprocess.run(
        [sys.executable, "-m", "imuwb", "health", static_mcap, "-o", "out.rrd"], capture_output=True, text=True, encoding="utf-8",
        cwd=tmp_path, check=False, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000)),
    )  # fmt: skip
    assert done.returncode == 1
    assert done.stderr.strip().endswith("out.rrd: cannot be written: File too large")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["static.mcap"]

"""imuwb report: parts are told apart and compared; other files are refused with what to do."""

import json
import re
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
import rerun as rr

from imuwb.cli import main
from imuwb.cli.report import check_runs, remarks_on, title_of
from imuwb.errors import UsageError

ROOT = Path(__file__).resolve().parents[2]


def part(hash_, sensor, version="1.0", run="a", analysis="noise", name="a.csv"):
    source = SimpleNamespace(hash=hash_, name=name)
    report = SimpleNamespace(
        run=run, version=version, sources=(source,), title=f"{analysis.capitalize()}: {name}", analysis=analysis
    )
    return SimpleNamespace(path=f"{run}.rrd", properties={"sensor": sensor} if sensor else {}), report


def test_parts_of_one_log_need_no_remark():
    assert remarks_on([part("1", "imu"), part("1", "imu", analysis="psd")]) == ()


def test_different_logs_sensors_and_versions_are_stated():
    logs, sensors = remarks_on([part("1", "imu"), part("2", ["imu2", "imu3"], name="b.csv")])
    assert "Noise: a.csv; Noise: b.csv" in logs
    assert "imu (Noise: a.csv); imu2, imu3 (Noise: b.csv)" in sensors
    assert "serial number" in remarks_on([part("1", "imu"), part("2", "imu")])[1]
    assert "1.0, 2.0" in remarks_on([part("1", "imu"), part("1", "imu", "2.0")])[0]


def test_one_run_is_given_once():
    with pytest.raises(UsageError, match=r"a\.rrd and a\.rrd are of the same run, a;"):
        check_runs([part("1", "imu"), part("2", "imu")])


def test_the_title_names_analyses_and_logs():
    reports = [
        report for _, report in (part("1", "i"), part("2", "i", analysis="outage", name="b.csv"), part("1", "i"))
    ]
    assert title_of(reports) == "Noise, outage: a.csv, b.csv"


@pytest.fixture
def imuwb(monkeypatch, tmp_path, capsys):
    """Run a command in a folder of its own; return its exit code and what it printed."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["imuwb", *map(str, arguments)])
        with pytest.raises(SystemExit) as end:
            main()
        return end.value.code, "".join(capsys.readouterr())

    return run


@pytest.mark.slow
def test_recordings_make_one_page_with_the_same_parts_as_their_own_pages(imuwb):
    log = ROOT / "samples" / "static.mcap"
    Path("jerk.py").write_text(
        next(
            b
            for b in re.findall(
                r"```python\n(.*?)```", (ROOT / "docs" / "how-to" / "plugin.md").read_text("utf-8"), re.DOTALL
            )
            if "# jerk.py" in b
        ),
        "utf-8",
    )
    for axis in "xy":
        code, text = imuwb(
            "./jerk.py",
            log,
            "--axis",
            axis,
            "--end",
            60,
            "-o",
            f"{axis}.rrd",
            "--html",
            f"{axis}.html",
            "--json",
            f"{axis}.json",
        )
        assert code == 0, text
    code, text = imuwb(
        "report", "x.rrd", "y.rrd", "-o", "both.html", "--tables", "tables", "--figures", "figures", "--format", "svg"
    )
    assert (code, "both.html" in text) == (0, True)
    page, own = Path("both.html").read_text("utf-8"), Path("x.html").read_text("utf-8")
    assert "exceeded jerk [m/s³]" in own  # the plugin of the pages appears without a change
    for said in (
        "exceeded jerk [m/s³]",
        *(json.loads(Path(f"{axis}.json").read_text("utf-8"))["run"] for axis in "xy"),
    ):
        assert said in page
    for path in re.findall(r' d="([^"]*)"', own):
        assert path in page
    assert "share of samples [%],exceeds [m/s³]" in Path("tables/jerk-answer.csv").read_text("utf-8")
    assert len(list(Path("figures").glob("*.svg"))) == page.count("<figure>")
    code, text = imuwb("report", "x.rrd", "x.rrd", "-o", "new.html")
    assert code == 2
    assert "same run" in text
    assert not Path("new.html").exists()


def test_other_files_are_refused_with_what_to_do(imuwb):
    other = rr.RecordingStream("other")
    other.save("other.rrd")
    other.log("x", rr.Scalars(1.0))
    other.disconnect()
    Path("x.json").write_text("{}")
    Path("cut.rrd").write_bytes(Path("other.rrd").read_bytes()[:-20])
    for name, said in (
        ("other.rrd", "another program"),
        ("x.json", "give the recording"),
        ("cut.rrd", "cut or damaged"),
        ("no.rrd", "no such file"),
    ):
        code, text = imuwb("report", name)
        assert (code, said in text) == (4, True), text
    assert not Path("report.html").exists()

import json
from pathlib import Path

from imuwb.cli import last_fault
from imuwb.cli.last_fault import masked

ROWS = "time [s],gyro_x [deg/s]\n" + "".join(f"{i / 100:.2f},{0.123456 + i:.6f}\n" for i in range(60))


def test_a_report_has_versions_and_the_log_without_samples_folders_or_users(imuwb, tmp_path, monkeypatch):
    monkeypatch.setattr(last_fault, "_own_names", lambda: ["annabel"])
    folder = tmp_path / "annabel secret"
    folder.mkdir()
    (folder / "log.csv").write_text(ROWS, "utf-8")
    done = imuwb("bug-report", folder / "log.csv", "-o", "report.json", IMUWB_LAST_FAULT=str(tmp_path / "none.json"))
    assert (done.code, "versions" in done.out) == (0, True), done.err
    text = (tmp_path / "report.json").read_text("utf-8")
    for hidden in ("annabel", "secret", str(tmp_path), "0.123456", "30.123456"):
        assert hidden not in text
    found = json.loads(text)
    assert found["log"]["summary"]["path"] == "log.csv"
    assert "deg/s" in text  # units are no paths
    assert found["log"]["summary"]["streams"]
    assert found["versions"]["numpy"]
    assert (found["last_fault"], len(found["content"])) == (None, 4)
    assert imuwb("bug-report", "-o", "report.json").code == 2  # it exists
    assert imuwb("bug-report", "missing.csv", "-o", "other.json").code == 4
    assert not (tmp_path / "other.json").exists()


def test_the_last_fault_is_kept_without_the_log(imuwb, tmp_path, monkeypatch):
    from imuwb.cli import info

    def broken(*_, **__):
        raise ZeroDivisionError("row 17 of /home/annabel/log.csv has 'value 9.81', not 3.5")

    monkeypatch.setattr(info, "_show", broken)
    monkeypatch.setenv("IMUWB_LAST_FAULT", str(tmp_path / "fault.json"))
    (tmp_path / "log.csv").write_text(ROWS, "utf-8")
    import contextlib
    import io
    import sys

    from imuwb.cli import main

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["imuwb", "info", "log.csv", "--full"])
    with contextlib.redirect_stderr(io.StringIO()) as err, contextlib.suppress(SystemExit):
        main()
    assert "bug-report" in err.getvalue()
    imuwb("bug-report", "-o", "report.json")
    fault = json.loads((tmp_path / "report.json").read_text("utf-8"))["last_fault"]
    assert (fault["kind"], fault["command"], fault["options"]) == ("ZeroDivisionError", "info", ["--full"])
    assert fault["message"] == "row # of log.csv has '...', not #"
    assert any("imuwb/cli/info.py" in frame for frame in fault["frames"])
    assert "annabel" not in json.dumps(fault)


def test_a_log_that_cannot_be_read_is_reported_with_its_error(imuwb, tmp_path):
    (tmp_path / "log.ulg").write_bytes(b"ULog\x01\x12\x35")
    imuwb("bug-report", "log.ulg", "-o", "report.json")
    log = json.loads((tmp_path / "report.json").read_text("utf-8"))["log"]
    assert log["error"].endswith("Error")
    assert log["size"] == 7


def test_messages_lose_numbers_quotes_and_folders():
    assert (
        masked("/data/x/y.csv: row 12: '3.25' is no number; see C:\\logs\\z.bin")
        == "y.csv: row #: '...' is no number; see z.bin"
    )
    assert masked(str(Path("plain"))) == "plain"

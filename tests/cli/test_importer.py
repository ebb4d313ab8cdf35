"""The importer that the viewer runs for every file: logs become recordings, all other files are declined at once."""

import subprocess
import sys

import pytest
import rerun as rr

from imuwb.cli.importer import may_be_ours
from imuwb.simulation import preset, static
from imuwb.writers import write

RUN = [sys.executable, "-c", "from imuwb.cli.importer import main; main()"]


def imported(*arguments):
    return subprocess.run([*RUN, *map(str, arguments)], capture_output=True, check=False, timeout=60)


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    path = tmp_path_factory.mktemp("importer") / "static.csv"
    write(static(preset("3dm-gx3-25"), 20, 50, 1), path)
    return path


@pytest.mark.slow
def test_a_log_becomes_a_recording_on_stdout(log, tmp_path):
    done = imported(log, "--application-id", "A", "--recording-id", "R")
    assert done.returncode == 0, done.stderr
    (tmp_path / "out.rrd").write_bytes(done.stdout)
    entities = {str(chunk.entity_path) for chunk in rr.chunk.RrdReader(str(tmp_path / "out.rrd")).stream()}
    assert any(path.startswith("/overview/") for path in entities)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("log.mcap", b"\x89MCAP0\r\n" + bytes(100)),
        ("recording.rrd", b"RRF2" + bytes(100)),
        ("picture.png", b"\x89PNG\r\n\x1a\n" + bytes(100)),
        ("notes.md", b"# Notes\n\n1, 2, 3\n"),
        ("data.csv", b"name,age\nAda,36\n"),
        ("empty.bin", b""),
    ],
)
def test_other_files_are_declined_and_nothing_is_written(tmp_path, name, content):
    (tmp_path / name).write_bytes(content)
    done = imported(tmp_path / name, "--recording-id", "R")
    assert (done.returncode, done.stdout) == (66, b"")


def test_a_file_that_is_not_there_is_declined(tmp_path):
    assert imported(tmp_path / "none.bin").returncode == 66


def test_without_a_file_it_names_the_command_for_users():
    done = imported()
    assert done.returncode == 2
    assert b"imuwb info" in done.stderr


def test_declining_a_file_imports_nothing_heavy(tmp_path):
    (tmp_path / "picture.png").write_bytes(b"\x89PNG" + bytes(10))
    code = (
        f"import sys; sys.argv = ['x', {str(tmp_path / 'picture.png')!r}]\n"
        "from imuwb.cli import importer\n"
        "try: importer.main()\nexcept SystemExit: print(sorted({'numpy', 'rerun', 'numba', 'typer'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60)
    assert done.stdout.strip() == "[]"


def frame(year, mark=0xFD):
    return int((year - 1970) * 365.2425 * 86_400e6).to_bytes(8, "big") + bytes([mark]) + bytes(20)


@pytest.mark.parametrize(
    ("name", "content", "ours"),
    [
        ("a.dat", frame(2024), True),
        ("a.dat", frame(2024, 0xFE), True),
        ("a.dat", frame(2024, 0xFC), False),
        ("a.dat", frame(1999), False),
        ("a.dat", frame(2101), False),
        ("a.dat", b"ULog\x01\x12\x35" + bytes(9), True),
        ("a.dat", b"#ROSBAG V2.0\n", True),
        ("a.dat", b"SQLite format 3\0", True),
        ("a.dat", b"% program   : RTKPOST", True),
        ("a.dat", bytes(9) + b"\xa3\x95\x80", True),
        ("a.csv", b"1,2,3\n", True),
        ("a.csv", b"1,\0,3\n", False),
        ("a.csv.gz", b"\x1f\x8b" + bytes(9), True),
        ("a.gz", b"\x1f\x8b" + bytes(9), False),
        ("a.dat", b"1,2,3\n", False),
    ],
)
def test_a_log_is_known_by_its_first_bytes_or_its_name(tmp_path, name, content, ours):
    (tmp_path / name).write_bytes(content)
    assert may_be_ours(tmp_path / name) == ours

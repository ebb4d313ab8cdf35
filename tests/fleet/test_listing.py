import sys
from pathlib import Path

import pytest

from imuwb.errors import UnreadableLogError
from imuwb.fleet.listing import found, logs_in
from imuwb.simulation import chamber, preset
from imuwb.writers import write


def test_a_folder_of_recordings_is_several_logs(tmp_path):
    model = preset("motionpakii")
    names = ("1_minus-30C.mcap", "2_0C.mcap")
    for log, name in zip(chamber(model, (-30.0, 0.0), 4, 50, 1), names, strict=True):
        write(log, tmp_path / name)
    (tmp_path / "1_minus-30C.json").write_text("{}")
    (tmp_path / "notes.bin").write_bytes(b"\x00nothing")
    assert [file.name for file in logs_in(tmp_path)] == list(names)
    (tmp_path / names[0]).unlink()
    assert logs_in(tmp_path) == (tmp_path,)  # a single recording is the folder's own
    (tmp_path / names[1]).unlink()
    with pytest.raises(UnreadableLogError, match="no log in this folder"):
        logs_in(tmp_path)


@pytest.mark.skipif(sys.platform == "win32", reason="links need a right there")
def test_a_glob_takes_what_a_folder_takes_and_each_file_once(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("logs/v0").mkdir(parents=True)
    for name in ("a.csv", "b.mcap", "a.csv.toml", "run.json", "progress.jsonl", "page.html"):
        Path("logs/v0", name).write_text("x")
    for name in ("sensors.parquet", "parts/0a/1b/tag.content.parquet"):
        Path("logs/results", name).parent.mkdir(parents=True, exist_ok=True)
        Path("logs/results", name).write_text("x")
    Path("logs/results/run.json").write_text("{}")
    Path("logs/v0/again").symlink_to(Path("../v0"))
    Path("logs/c.csv").symlink_to("v0/a.csv")
    for pattern in ("logs/", "logs/**/*"):
        assert [Path(log.place).name for log in found([pattern])] == ["c.csv", "b.mcap"], pattern
    assert [Path(log.place).name for log in found(["logs/v0/*.json", "logs/v0/a.csv.toml"])] == [
        "a.csv.toml",
        "run.json",
    ]

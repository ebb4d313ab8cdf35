import pytest

from imuwb.errors import UnreadableLogError
from imuwb.fleet.listing import logs_in
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

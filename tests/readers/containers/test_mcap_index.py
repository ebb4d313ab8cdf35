import pytest

from imuwb import describe, read
from imuwb.simulation import preset, static
from imuwb.summary import summarize
from imuwb.writers import write


def test_the_index_says_what_reading_finds(tmp_path):
    path = tmp_path / "s.mcap"
    write(static(preset("3dm-gx3-25"), 400, 50, 1), path)
    quick, whole = describe(path), summarize(read(path))
    assert "index" in quick.notes[0]
    for a, b in zip(quick.streams, whole.streams, strict=True):
        assert (a.name, a.kind, a.count, a.epoch, a.units, a.frame) == (
            b.name,
            b.kind,
            b.count,
            b.epoch,
            b.units,
            b.frame,
        )
        assert a.rate_hz == pytest.approx(b.rate_hz, rel=0.01)
        assert a.start_ns <= b.start_ns
        assert a.end_ns >= b.end_ns


@pytest.mark.parametrize("encoding", ["json", "protobuf", "ros1msg_lz4", "ros2cdr_zstd", "ros2cdr_unchunked"])
def test_all_encodings_are_described(shared, encoding):
    found = describe(shared / "mcap" / f"husky_test1_{encoding}.mcap")
    odometry = set() if encoding in ("json", "protobuf") else {("speed", 3952)}
    assert {(s.kind, s.count) for s in found.streams} == {("imu", 11865), ("gnss", 989)} | odometry


def test_a_cut_file_has_no_index_and_is_read(tmp_path):
    path = tmp_path / "s.mcap"
    write(static(preset("3dm-gx3-25"), 400, 50, 1), path)
    path.write_bytes(path.read_bytes()[:-100])
    assert describe(path).streams[0].count == 20_000

import pytest
from mcap.writer import Writer

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


def test_the_index_names_what_is_not_used(tmp_path, ros):
    path = tmp_path / "log.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start("", "test")
        for topic, kind, text in (
            ("/imu", "sensor_msgs/msg/Imu", ros.imu_2),
            ("/own", "my_msgs/msg/Own", ""),
            ("/chat", "std_msgs/msg/String", "string data\n"),
        ):
            schema = writer.register_schema(kind, "ros2msg", text.encode())
            channel = writer.register_channel(topic, "cdr", schema)
            writer.add_message(channel, 10**18, ros.imu(10**18, (0.1, 0, 0), (0, 0, 9.8)), 10**18)
        writer.add_attachment(0, 0, "calibration.yaml", "text/yaml", bytes(100))
        writer.add_metadata("theirs", {"driver": "1.2"})
        writer.finish()
    quick, whole = describe(path), summarize(read(path))
    assert [stream.name for stream in quick.streams] == ["/imu"]
    assert len(quick.notes[1:]) == len(whole.notes) == 3
    for part in ("/own", "--messages", "/chat", "calibration.yaml (text/yaml, 100 bytes)", "metadata theirs"):
        assert all(any(part in note for note in notes) for notes in (quick.notes, whole.notes))

import pytest
from mcap.writer import Writer

from imuwb import describe, read
from imuwb.readers import ReadOptions
from imuwb.ros import definition
from imuwb.simulation import preset, static
from imuwb.summary import summarize
from imuwb.writers import write
from tests.conftest import Topic, write_mcap


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
    odometry = set() if encoding in ("json", "protobuf") else {("speed", 3952), ("pose", 3952)}
    streams = {(s.kind, s.count) for s in found.streams if s.kind != "orientation"}  # no index shows whether it is set
    assert streams == {("imu", 11865), ("gnss", 989)} | odometry


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


def test_the_parts_of_a_recording_are_described_as_one(tmp_path, ros):
    folder, start, step = tmp_path / "drive", 10**18, 10**7
    folder.mkdir()
    for part in range(3):
        rows = [
            (start + i * step, ros.imu(start + i * step, (0.1, 0, 0), (0, 0, 9.8)))
            for i in range(part * 50, part * 50 + 50)
        ]
        write_mcap(folder / f"drive_{part}.mcap", Topic(rows), Topic(rows, "/own", "my_msgs/msg/Own", "", ""))
    (stream,), notes = describe(folder).streams, describe(folder).notes
    (whole,) = summarize(read(folder)).streams
    assert (stream.name, stream.count, stream.start_ns, stream.end_ns) == ("/imu", 150, start, start + 149 * step)
    assert (stream.rate_hz, stream.units, stream.frame) == (pytest.approx(whole.rate_hz), whole.units, whole.frame)
    assert [note.id for note in notes] == ["parts", "from_index", "unused"]
    (folder / "drive_1.mcap").write_bytes((folder / "drive_1.mcap").read_bytes()[:-50])
    assert describe(folder).streams[0].gaps == ()


def test_definitions_that_are_given_count_for_the_index(tmp_path, ros):
    stamp = 10**18
    path = write_mcap(
        tmp_path / "a.mcap",
        Topic([(stamp, ros.imu(stamp, (0.1, 0, 0), (0, 0, 9.8)))], "/imu", "my_msgs/msg/Own", "", ""),
    )
    (tmp_path / "my_msgs" / "msg").mkdir(parents=True)
    (tmp_path / "my_msgs" / "msg" / "Own.msg").write_text(definition("sensor_msgs/Imu").partition("=====")[0], "utf-8")
    assert describe(path).streams == ()
    assert [stream.name for stream in describe(path, ReadOptions(messages=tmp_path)).streams] == ["/imu"]

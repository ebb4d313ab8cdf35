"""Recordings of several files, and packed ones, are read as one log; what is missing is named."""

import gzip

import numpy as np
import pytest
import zstandard

from imuwb.errors import UnreadableLogError
from imuwb.notes import ids
from imuwb.readers import read, reader_of
from tests.conftest import Topic, write_mcap

from .bag_writer import MAGIC, connection, message
from .db3_writer import write_db3

T = 1_714_564_800 * 10**9
PART = 10  #: messages of a part
IMU = "sensor_msgs/msg/Imu"


@pytest.fixture(scope="module")
def rows(ros):
    """Return a function that gives the messages of a part, at 100 Hz, each with its number as a rate."""

    def of(part, code=1):
        numbers = range(part * PART, part * PART + PART)
        stamps = [T + i * 10**7 for i in numbers]
        return [(t, ros.imu(t, (float(i), 0, 0), (0, 0, 9.8), code=code)) for i, t in zip(numbers, stamps, strict=True)]

    return of


def db3(path, messages, definition):
    # the number of a topic differs from part to part
    other = {"/other": ("std_msgs/msg/String", [])} if int(messages[0][0]) % 20 else {}
    return write_db3(path, {**other, "/imu": (IMU, messages)})


def mcap(path, messages, definition):
    return write_mcap(path, Topic(messages))


def bag(path, messages, definition):
    path.write_bytes(MAGIC + connection(0, definition) + b"".join(message(0, t, payload) for t, payload in messages))
    return path


WRITERS = {".db3": db3, ".mcap": mcap, ".bag": bag}


@pytest.fixture
def recording(tmp_path, ros, rows):
    """Return a function that writes parts of a recording by their names, and perhaps ``metadata.yaml``."""

    def write(suffix, *numbers, name="drive_{}", listed=None, pack=None, count=None):
        folder = tmp_path / "drive"
        folder.mkdir()
        for number in numbers:
            messages = rows(number, ros.ROS_1 if suffix == ".bag" else 1)
            path = WRITERS[suffix](folder / f"{name.format(number)}{suffix}", messages, ros.imu_1)
            if pack is not None:
                path.with_name(f"{path.name}{pack}").write_bytes(PACKERS[pack](path.read_bytes()))
                path.unlink()
        if listed is not None:
            write_metadata(folder, listed, count)
        return folder

    return write


PACKERS = {".zstd": zstandard.compress, ".gz": gzip.compress}


def write_metadata(folder, names, count=None):
    lines = "".join(f"    - {name}\n" for name in names)
    (folder / "metadata.yaml").write_text(
        "rosbag2_bagfile_information:\n  version: 9\n  storage_identifier: sqlite3\n  duration:\n    nanoseconds: 1\n"
        f"  message_count: {PART * len(names) if count is None else count}\n  topics_with_message_count:\n"
        "    - topic_metadata:\n        name: /imu\n        type: sensor_msgs/msg/Imu\n      message_count: 999999\n"
        f'  compression_format: ""\n  compression_mode: ""\n  relative_file_paths:\n{lines}'
        f"  files:\n    - path: other.db3\n      message_count: 888888\n",
        "utf-8",
    )


def numbers_of(log):
    (imu,) = log.imus
    numbers = imu.angular_rate.value[:, 0]
    assert imu.angular_rate.time.tolist() == [T + int(i) * 10**7 for i in numbers]
    assert imu.origin.repairs == ()
    return numbers.tolist()


@pytest.mark.parametrize("suffix", WRITERS)
def test_parts_are_one_log_in_the_order_of_their_numbers(recording, suffix):
    folder = recording(suffix, *range(12))  # 10 and 11 follow 9, though their names do not
    log = read(folder)
    assert numbers_of(log) == list(range(12 * PART))
    assert ids(log.notes) == ("parts",)
    assert (log.provenance.format, reader_of(folder).format) == (suffix[1:], suffix[1:])
    assert log.provenance.size == sum(file.stat().st_size for file in folder.iterdir())


@pytest.mark.parametrize("name", ["drive_{}", "split_2024-05-01-12-00-0{0}_{0}", "2024_05_01-12_00_0{0}_{0}"])
def test_numbered_names_may_have_a_date(recording, name):
    assert len(numbers_of(read(recording(".bag", 0, 1, 2, name=name)))) == 3 * PART


@pytest.mark.parametrize("suffix", [".db3", ".mcap"])
def test_the_order_and_the_parts_of_the_metadata_count(recording, suffix):
    folder = recording(suffix, 0, 1, 2, name="{}", listed=[f"1{suffix}", f"2{suffix}"])
    (folder / "notes.txt").write_text("a drive", "utf-8")
    log = read(folder)
    assert numbers_of(log) == [float(i) for i in range(PART, 3 * PART)]
    assert ids(log.notes) == ("parts", "unused")
    assert f"0{suffix}" in log.notes[1]


@pytest.mark.parametrize(
    "lines",
    ['["drive_0.db3", "drive_1.db3"]', "[drive_0.db3,drive_1.db3]", "\n  - drive_0.db3\n  - drive_1.db3",
     '\n    - "old_folder/drive_0.db3"\n    - \'old_folder/drive_1.db3\'', "\n    - drive_0.db3.zstd\n    - drive_1.db3.zstd"],
)  # fmt: skip
def test_the_list_of_files_may_have_any_form_of_yaml(recording, lines):
    folder = recording(".db3", 0, 1)
    (folder / "metadata.yaml").write_text(
        f"rosbag2_bagfile_information:\n  relative_file_paths: {lines}\n  files: []\n", "utf-8"
    )
    log = read(folder)
    assert len(numbers_of(log)) == 2 * PART
    assert ids(log.notes) == ("parts",)


def test_a_part_that_the_metadata_lists_is_missed(recording):
    log = read(recording(".db3", 0, 2, listed=["drive_0.db3", "drive_1.db3", "drive_2.db3"]))
    assert len(numbers_of(log)) == 2 * PART
    assert ids(log.notes) == ("parts", "part_missing", "messages_missing")
    assert "drive_1.db3" in log.notes[1]
    assert "10 of the 30 messages" in log.notes[2]


@pytest.mark.parametrize(("numbers", "missing"), [((0, 2, 5), "1, 3, 4 of 6"), ((1, 2), "0 of 3")])
def test_a_number_that_is_missing_is_named(recording, numbers, missing):
    log = read(recording(".bag", *numbers))
    assert len(numbers_of(log)) == PART * len(numbers)
    assert "part_missing" in ids(log.notes)
    assert any(missing in note for note in log.notes)


def test_a_part_that_cannot_be_read_is_named(recording):
    folder = recording(".db3", 0, 1, 2, listed=["drive_0.db3", "drive_1.db3", "drive_2.db3"])
    (folder / "drive_1.db3").write_bytes(b"SQLite format 3\0 topics" + bytes(500))
    log = read(folder)
    assert len(numbers_of(log)) == 2 * PART
    assert any("drive_1.db3" in note and note.id == "cut" for note in log.notes)


def test_several_recordings_in_a_folder_are_refused_by_their_names(recording, tmp_path):
    folder = recording(".bag", 0)
    (folder / "walk.bag").write_bytes((folder / "drive_0.bag").read_bytes())
    with pytest.raises(UnreadableLogError, match=r"drive_0\.bag, walk\.bag"):
        read(folder)


def test_a_folder_without_a_recording_is_refused(tmp_path):
    (tmp_path / "picture.png").write_bytes(b"x")
    with pytest.raises(UnreadableLogError, match="directory"):
        read(tmp_path)
    write_metadata(tmp_path, ["drive_0.db3"])
    with pytest.raises(UnreadableLogError, match=r"drive_0\.db3"):
        read(tmp_path)


@pytest.mark.parametrize("suffix", WRITERS)
@pytest.mark.parametrize("pack", PACKERS)
def test_packed_files_are_read_in_a_folder_and_alone(recording, suffix, pack):
    folder = recording(suffix, 0, 1, pack=pack, listed=[f"drive_{i}{suffix}{pack}" for i in range(2)])
    assert len(numbers_of(read(folder))) == 2 * PART
    alone = read(folder / f"drive_1{suffix}{pack}")
    assert numbers_of(alone) == [float(i) for i in range(PART, 2 * PART)]
    assert ids(alone.notes) == ("one_part",)


def test_a_packed_file_that_is_cut_gives_its_beginning(recording, rows):
    folder = recording(".bag", 0, 1)
    path = folder / "drive_0.bag"
    data, packed = path.read_bytes(), path.with_name("cut.bag.zst")
    pieces = [data[at : at + 1000] for at in range(0, len(data), 1000)]
    packed.write_bytes(b"".join(map(zstandard.compress, pieces))[:-100])
    log = read(packed)
    assert 0 < len(numbers_of(log)) <= PART
    assert "packed_cut" in ids(log.notes)


def test_progress_grows_to_the_size_of_all_files(recording):
    folder = recording(".bag", 0, 1, 2, pack=".gz")
    seen = []
    read(folder, progress=lambda done, size: seen.append(done / size))
    assert seen == sorted(seen)
    np.testing.assert_allclose(seen[-1], 1, atol=0.02)


def test_what_is_read_leaves_no_file(recording, tmp_path, monkeypatch):
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(temporary))
    folder = recording(".db3", 0, 1, pack=".zstd")
    before = sorted(folder.iterdir())
    read(folder)
    assert sorted(folder.iterdir()) == before
    assert list(temporary.iterdir()) == []


def test_a_part_that_is_there_twice_is_read_once(recording):
    folder = recording(".db3", 0, 1)
    for i in range(2):
        path = folder / f"drive_{i}.db3"
        path.with_name(f"{path.name}.zstd").write_bytes(zstandard.compress(path.read_bytes()))
    log = read(folder)
    assert len(numbers_of(log)) == 2 * PART
    assert ids(log.notes) == ("parts", "unused")
    assert "drive_0.db3.zstd, drive_1.db3.zstd" in log.notes[1]


def test_recordings_of_another_format_in_the_folder_are_named(recording, tmp_path, rows):
    folder = recording(".bag", 0)
    mcap(folder / "converted.mcap", rows(1), None)
    log = read(folder)
    assert log.provenance.format == "mcap"
    assert ids(log.notes) == ("unused",)
    assert "drive_0.bag" in log.notes[0]


def test_the_metadata_alone_are_no_log(tmp_path):
    write_metadata(tmp_path, ["drive_0.db3"])
    with pytest.raises(UnreadableLogError, match="folder"):
        read(tmp_path / "metadata.yaml")

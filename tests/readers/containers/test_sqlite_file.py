"""Recordings in SQLite whose recorder was killed: committed rows beside the file are read, and no file is changed."""

import shutil
import sqlite3
from contextlib import closing
from types import SimpleNamespace

import pytest

from imuwb.errors import UnreadableLogError
from imuwb.notes import ids
from imuwb.readers import read
from imuwb.readers.containers import sqlite_file

from .db3_writer import OLD, fill, insert

T = 1_714_564_800 * 10**9
IMU = "sensor_msgs/msg/Imu"


@pytest.fixture(scope="module")
def rows(ros):
    """Return messages (time, topic's number, payload) of an IMU at 100 Hz."""
    return [(T + i * 10**7, 1, ros.imu(T + i * 10**7, (i / 1000, 0, 0), (0, 0, 9.8))) for i in range(180)]


@pytest.fixture(scope="module")
def killed(fresh, rows):
    """Return a function that leaves the files of a recorder that was killed: so many messages before and after the checkpoint."""

    def leave(before, after, mode="WAL", pages=10_000):
        base, path = fresh("log.db3"), fresh("log.db3")
        with closing(sqlite3.connect(base)) as database:
            database.execute(f"PRAGMA journal_mode={mode}")
            database.execute("PRAGMA wal_autocheckpoint=0")
            if before is not None:
                database.executescript(OLD)
                fill(database, {"/imu": (IMU, [])})
                insert(database, rows[:before])
                database.commit()
                database.execute("PRAGMA wal_checkpoint(TRUNCATE)")
            else:
                database.execute("VACUUM")
                database.executescript(OLD)
                fill(database, {"/imu": (IMU, [])})
                before = 0
            database.execute(f"PRAGMA cache_size={pages}")
            for i in range(before, before + after, 50):
                insert(database, rows[i : i + 50])
                if mode == "WAL":
                    database.commit()
            for file in base.parent.iterdir():
                if not file.name.endswith("-shm"):  # a killed recorder leaves it; it need not be copied with the others
                    shutil.copyfile(file, path.with_name(file.name))
        return path

    return leave


def snapshot(path):
    return {file.name: file.read_bytes() for file in path.parent.iterdir()}


def read_unchanged(path):
    before = snapshot(path)
    log = read(path)
    assert snapshot(path) == before
    return log


@pytest.mark.parametrize(("before", "after"), [(30, 150), (None, 180), (180, 0)])
def test_the_rows_of_a_write_ahead_log_are_read(killed, before, after):
    path = killed(before, after)
    assert path.with_name("log.db3-wal").exists()
    log = read_unchanged(path)
    assert log.imu().angular_rate.time.tolist() == [T + i * 10**7 for i in range(180)]
    assert log.imu().angular_rate.value[:, 0].tolist() == [i / 1000 for i in range(180)]
    assert ids(log.notes) == (("write_ahead_log_applied",) if after else ())
    assert not after or f"{after} messages" in log.notes[0]


def test_the_file_of_shared_memory_does_no_harm(killed):
    path = killed(30, 150)
    path.with_name("log.db3-shm").write_bytes(bytes(32768))
    assert len(read_unchanged(path).imu().angular_rate) == 180


def test_a_write_ahead_log_that_is_missing_is_named(killed):
    path = killed(30, 150)
    path.with_name("log.db3-wal").unlink()
    log = read_unchanged(path)
    assert len(log.imu().angular_rate) == 30
    assert ids(log.notes) == ("write_ahead_log_missing",)
    assert "log.db3-wal" in log.notes[0]


def test_a_write_ahead_log_that_is_cut_gives_its_whole_writes(killed):
    path = killed(30, 150)
    wal = path.with_name("log.db3-wal")
    wal.write_bytes(wal.read_bytes()[:-1000])
    log = read_unchanged(path)
    assert len(log.imu().angular_rate) == 130
    assert "100 messages" in log.notes[0]


def test_a_write_ahead_log_without_room_for_a_copy_is_named_with_its_remedy(killed, monkeypatch):
    path = killed(30, 150)
    full = SimpleNamespace(free=0)
    monkeypatch.setattr(sqlite_file.shutil, "disk_usage", lambda _: full)
    log = read_unchanged(path)
    assert len(log.imu().angular_rate) == 30
    assert ids(log.notes) == ("write_ahead_log_left_out",)
    assert "log.db3-wal" in log.notes[0]
    assert "checkpoint" in log.notes[0]


def test_an_open_write_is_taken_back(killed):
    path = killed(30, 150, mode="DELETE", pages=1)  # a small cache, so that pages of the open write are in the file
    assert path.with_name("log.db3-journal").stat().st_size
    log = read_unchanged(path)
    assert log.imu().angular_rate.time.tolist() == [T + i * 10**7 for i in range(30)]
    assert ids(log.notes) == ("journal_applied",)


def test_a_journal_that_is_done_is_no_matter(killed):
    path = killed(180, 0, mode="PERSIST")
    assert path.with_name("log.db3-journal").exists()
    log = read_unchanged(path)
    assert len(log.imu().angular_rate) == 180
    assert log.notes == ()


def test_a_database_of_something_else_in_this_mode_is_refused(fresh):
    path = fresh("other.db")
    with closing(sqlite3.connect(path)) as database:
        database.execute("PRAGMA journal_mode=WAL")
        database.executescript("CREATE TABLE people(name TEXT)")
    with pytest.raises(UnreadableLogError, match="topics"):
        read(path)

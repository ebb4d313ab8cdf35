"""Files are old or new, never a part or a mixture, whatever ends the process that writes them."""

import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

from imuwb import readers, renames
from imuwb.errors import ImuwbError, UnreadableLogError
from imuwb.log import ImuStream, Log, Origin, Provenance, Triad
from imuwb.renames import draft_of
from imuwb.writers import together, whole, whole_file, write, write_text


class Killed(BaseException):
    """Stands for a signal that no program can catch."""


def log_of(epoch, rate):
    time = np.arange(50) * 10_000_000
    triads = [Triad(time, np.full((50, 3), value)) for value in (rate, 9.8)]
    imu = ImuStream("imu", *triads, origin=Origin(frame="FRD", epoch=epoch))
    return Log(Provenance("x", "test", "", 0), imus=(imu,))


def read_state(path):
    imu = readers.read(path).imu()
    return imu.origin.epoch, float(imu.angular_rate.value[0, 0])


@pytest.fixture
def kill(monkeypatch):
    """Return a function that ends the writing before its n-th rename, removal, or wait for the disk, with nothing cleaned up."""

    def before(count, work):
        left, locks = [count], []

        def killing(done):
            def work(*arguments, **named):
                if not left[0]:
                    raise Killed
                left[0] -= 1
                return done(*arguments, **named)

            return work

        with monkeypatch.context() as patch:
            for owner, name in ((Path, "replace"), (Path, "unlink"), (os, "fsync")):
                patch.setattr(owner, name, killing(getattr(owner, name)))
            patch.setattr(whole.Draft, "discard", lambda draft: locks.append(draft.lock))
            try:
                work()
            except Killed:
                return True
            finally:
                for lock in locks:
                    lock.close()
        return False

    return before


def test_a_table_and_its_sidecar_read_as_old_or_new_at_every_kill(kill, tmp_path):
    path, states, killed = tmp_path / "o.csv", [], True
    old, new = log_of("boot", 1.0), log_of("unix", 2.0)
    while killed:
        write(old, path)
        assert sorted(os.listdir(tmp_path)) == ["o.csv", "o.csv.toml"]  # nothing is left of the kill before
        killed = kill(len(states), lambda: write(new, path))
        states.append(read_state(path))
    assert len(states) > 6
    assert states == sorted(states)
    assert {*states} == {("boot", 1.0), ("unix", 2.0)}


def test_files_in_two_folders_are_all_old_or_all_new_after_any_kill(kill, tmp_path):
    files = [tmp_path / "a" / "one", tmp_path / "b" / "two", tmp_path / "b" / "three"]
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()

    def run(text):
        with together(files[:1]), together(files[1:]):
            for file in files:
                write_text(file, text)

    for asked in files:
        states, killed = [], True
        while killed:
            run("old")
            killed = kill(len(states), lambda: run("new"))
            renames.settle(asked)
            states.append({file.read_text() for file in files})
        assert states == [{"old"}] * states.count({"old"}) + [{"new"}] * states.count({"new"})
        assert 4 < states.count({"old"}) < len(states) - 4
    run("last")
    assert sorted(os.listdir(tmp_path / "a") + os.listdir(tmp_path / "b")) == ["one", "three", "two"]


@pytest.mark.parametrize(
    "content",
    ["", "{", "[" * 5000, "7", '{"files": 3}', '{"files": {"": "x", "/": "x", "a\\u0000": "x", "one": 3}}', '{"journal": "../nowhere"}',
     '{"files": {"one": "sha256-ends:0", "../one": "x"}}'],
)  # fmt: skip
def test_a_journal_that_is_cut_or_foreign_renames_nothing(tmp_path, content):
    (tmp_path / "one").write_text("old")
    draft_of(tmp_path / "one").write_text("new")
    renames.journal_of(tmp_path / "one").write_text(content)
    renames.settle(tmp_path / "one")
    assert ((tmp_path / "one").read_text(), draft_of(tmp_path / "one").read_text()) == ("old", "new")


def test_a_name_that_cannot_be_given_is_named(tmp_path, monkeypatch):
    def no(*_):
        raise PermissionError(1, "not allowed")

    place = tmp_path / "one"
    draft_of(place).write_text("new")
    renames.begin([place])
    with monkeypatch.context() as patch:
        patch.setattr(Path, "replace", no)
        with pytest.warns(UserWarning, match=r"one: .*not allowed.*\.one\.partial"):
            renames.settle(place)
    renames.settle(place)
    assert (place.read_text(), os.listdir(tmp_path)) == ("new", ["one"])


def test_a_sidecar_of_another_table_is_refused_and_one_written_by_hand_is_used(tmp_path):
    path, sidecar = tmp_path / "o.csv", tmp_path / "o.csv.toml"
    write(log_of("boot", 1.0), path)
    path.write_text(path.read_text("utf-8").replace("9.8", "9.7"), "utf-8")
    with pytest.raises(UnreadableLogError, match=r"o\.csv\.toml was written with another table.*delete the line"):
        readers.read(path)
    sidecar.write_text(
        "\n".join(t for t in sidecar.read_text("utf-8").splitlines() if not t.startswith("table")), "utf-8"
    )
    assert read_state(path) == ("boot", 1.0)


def test_files_of_a_run_get_their_names_together(kill, tmp_path):
    files = [tmp_path / name for name in "abc"]

    def run(text):
        with together(files):
            for file in files[:2]:
                write_text(file, text)
            write_text(tmp_path / "apart", text)

    run("old")
    assert sorted(os.listdir(tmp_path)) == ["a", "apart", "b"]
    assert kill(3, lambda: run("new"))
    assert [files[0].read_text(), files[1].read_text(), (tmp_path / "apart").read_text()] == ["old", "old", "new"]
    with pytest.raises(ImuwbError, match="no folder"), together(files):  # noqa: PT012 - the second write fails
        write_text(files[0], "new")
        write_text(tmp_path / "no folder" / "a", "new")
    assert files[0].read_text() == "old"
    run("new")
    assert [file.read_text() for file in files[:2]] == ["new", "new"]
    assert sorted(os.listdir(tmp_path)) == ["a", "apart", "b"]


def test_a_second_writer_is_told_and_the_first_wins_whole(tmp_path):
    place = tmp_path / "a"
    with whole_file(place) as temporary:
        temporary.write_text("first", "utf-8")
        with pytest.raises(ImuwbError, match="another process of imuwb writes this file"):
            write_text(place, "second")
        command = f"from imuwb.writers import write_text; write_text({str(place)!r}, 'third')"
        done = subprocess.run([sys.executable, "-c", command], capture_output=True, text=True, check=False)
        assert "another process of imuwb writes this file" in done.stderr
    assert place.read_text("utf-8") == "first"
    write_text(place, "second")
    assert (place.read_text("utf-8"), os.listdir(tmp_path)) == ("second", ["a"])


def test_a_disk_that_is_full_at_the_end_leaves_the_old_file(tmp_path, monkeypatch):
    write_text(tmp_path / "a", "old")
    monkeypatch.setattr(os, "fsync", lambda _: os.write(os.open("/dev/full", os.O_WRONLY), b"1"))
    with pytest.raises(ImuwbError, match="a: cannot be written: No space left on device"):
        write_text(tmp_path / "a", "new")
    assert ((tmp_path / "a").read_text(), os.listdir(tmp_path)) == ("old", ["a"])


@pytest.mark.skipif(not hasattr(signal, "SIGHUP"), reason="the system has no such signals")
def test_signals_wait_until_all_files_of_a_run_have_their_names(tmp_path, monkeypatch):
    came, rename, files = [], Path.replace, [tmp_path / "a", tmp_path / "b"]
    before = signal.signal(signal.SIGTERM, lambda number, _: came.append((number, sorted(os.listdir(tmp_path)))))

    def replace(self, target):
        os.kill(os.getpid(), signal.SIGTERM)
        return rename(self, target)

    monkeypatch.setattr(Path, "replace", replace)
    try:
        with together(files):
            for file in files:
                write_text(file, "new")
    finally:
        signal.signal(signal.SIGTERM, before)
    assert set(map(str, came)) == {str((signal.SIGTERM.value, ["a", "b"]))}


def test_a_thread_writes_too(tmp_path):
    thread = threading.Thread(target=write_text, args=(tmp_path / "a", "new"))
    thread.start()
    thread.join()
    assert (tmp_path / "a").read_text() == "new"
    assert not draft_of(tmp_path / "a").exists()


@pytest.mark.skipif(not hasattr(signal, "SIGHUP"), reason="the system has no such signals")
@pytest.mark.parametrize("when", ["locked", "_rename"])
def test_an_interruption_at_the_begin_or_at_the_end_leaves_no_draft(tmp_path, monkeypatch, when):
    def interrupt(number, _):
        raise KeyboardInterrupt(number)

    def work(*arguments):
        os.kill(os.getpid(), signal.SIGTERM)
        return done(*arguments)

    done = getattr(whole, when)
    before = signal.signal(signal.SIGTERM, interrupt)
    monkeypatch.setattr(whole, when, work)
    try:
        for files in ((), (tmp_path / "a", tmp_path / "b")):
            with pytest.raises(KeyboardInterrupt), together(files):
                write_text(tmp_path / "a", "new")
            assert os.listdir(tmp_path) == []
    finally:
        signal.signal(signal.SIGTERM, before)

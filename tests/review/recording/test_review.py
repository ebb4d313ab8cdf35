import threading

import numpy as np
import pytest
from rerun.chunk import RrdReader

from imuwb.analysis import Series, Table
from imuwb.errors import ImuwbError
from imuwb.log import SECOND
from imuwb.review.recording import review as module
from imuwb.review.recording.review import RecordingReview
from imuwb.review.recording.rrd import is_whole, why_cut
from imuwb.review.recording.tab import Tab
from imuwb.review.scene.clock import Clock


def test_a_recording_contains_all_that_was_shown(review, line, entities, tmp_path):
    shown, review = review.shown, review.review
    review.tab("Mine")
    review.figure(line([1.0, 10.0], [1.0, 2.0]))
    time = np.arange(5000, dtype=np.int64) * SECOND
    review.series(Series("s", "m", time, np.ones((5000, 3)), ("a", "b", "c")))
    review.table(Table("T", ("a", "b"), (("1 m", "x|y"),)))
    position = np.array([[0.8, 0.1, 0.0], [0.80001, 0.10001, 0.0]])
    review.track("gnss", position, (1, 2, 3))
    review.map_track("gnss", position, (1, 2, 3))
    review.note("look here")
    assert not (tmp_path / "r.rrd").exists()
    paths = entities(review.close())
    for end in ("figure_0/texts", "series_0", "text_1", "text_2", "track/texts", "map/0_gnss"):
        assert f"/mine/{end}" in paths
    assert [type(item).__name__ for item in shown] == ["Table", "str"]
    assert [p.name for p in tmp_path.iterdir()] == ["r.rrd"]


def test_names_of_series_have_their_unit(review):
    time = np.arange(10, dtype=np.int64)
    review.review.series(Series("s", "m/s", time, np.ones((10, 1)), ("a",)))
    names = [
        chunk.to_record_batch().column("SeriesLines:names")[0].as_py()
        for chunk in RrdReader(str(review.review.close())).stream()
        if "SeriesLines:names" in chunk.to_record_batch().schema.names
    ]
    assert names == [["a [m/s]"]]


def test_a_discarded_review_leaves_no_file(review, tmp_path):
    review.review.note("x")
    review.review.discard()
    assert list(tmp_path.iterdir()) == []


def test_a_place_that_cannot_be_written_is_an_error(tmp_path):
    with pytest.raises(ImuwbError, match="cannot be written"):
        RecordingReview(tmp_path / "no" / "r.rrd")


def test_a_recording_without_its_first_or_last_bytes_is_not_whole(review, tmp_path):
    data = review.review.close().read_bytes()
    for content, whole in ((data, True), (data[:-1], False), (data[1:], False), (b"", False)):
        (tmp_path / "part.rrd").write_bytes(content)
        assert is_whole(tmp_path / "part.rrd") == whole
    assert why_cut(tmp_path / "no" / "r.rrd") == "No such file or directory"


def test_a_series_takes_the_clock_of_the_log_and_another_clock_is_an_error(tmp_path):
    time = np.arange(10, dtype=np.int64)
    review = RecordingReview(tmp_path / "r.rrd", clock=Clock("unix", 0))
    review.series(Series("mine", "m", time, np.ones((10, 1)), ("a",)))
    with pytest.raises(ValueError, match="'other' counts its time from the power-up, the recording from 1970"):
        review.series(Series("other", "m", time, np.ones((10, 1)), ("a",), epoch="boot"))
    assert review.drawn[0].item.epoch == "unix"
    timelines = {name for chunk in RrdReader(str(review.close())).stream() for name in chunk.timeline_names}
    assert timelines == {"time"}


def test_a_text_of_a_log_is_no_markup_and_no_control_character(logged):
    tab = Tab.of("My tab")
    tab.tables.append(Table("T", ("a|b",), (("<b>*x* [y](http://z)\u2028\x1b[2J",),), "_c_"))
    tab.layout(logged)
    (text,) = logged["/my_tab/text_0"][0].text.as_arrow_array().to_pylist()
    assert text.splitlines()[0] == "| a\\|b |"
    assert "\\<b\\>\\*x\\* \\[y\\](http://z)" in text
    assert "\\_c\\_" in text
    assert not {"\u2028", "\x1b"} & set(text)


def test_an_empty_tab_has_no_layout():
    assert Tab.of("empty").layout(None) is None


def test_a_writer_that_never_answers_ends_as_a_file_that_is_not_whole(tmp_path, monkeypatch):
    """As on a full disk: the library then waits without end."""
    review = RecordingReview(tmp_path / "a.rrd")
    asked = []

    def flush(*, timeout_sec):
        asked.append(timeout_sec)
        raise RuntimeError("timeout")

    monkeypatch.setattr(review.recording, "flush", flush)
    monkeypatch.setattr(module, "is_whole", lambda _: False)
    with pytest.raises(ImuwbError, match="cannot be written"):
        review.close()
    assert asked in ([module.PATIENCE], [module.PATIENCE] * 2)
    assert not list(tmp_path.iterdir())


def test_a_library_that_never_lets_go_of_the_file_does_not_hold_the_program(tmp_path, monkeypatch):
    """As on a full disk, where the thread that writes has ended and the library waits for it, at the exit of the program too."""
    review = RecordingReview(tmp_path / "r.rrd")
    let_go, unregistered = threading.Event(), []
    monkeypatch.setattr(module, "LEAVING", 0.05)
    monkeypatch.setattr(module.rr, "unregister_shutdown", lambda: unregistered.append(True))
    monkeypatch.setattr(type(review.recording), "disconnect", lambda _: let_go.wait(20))
    review.discard()
    let_go.set()
    assert unregistered
    assert not list(tmp_path.iterdir())

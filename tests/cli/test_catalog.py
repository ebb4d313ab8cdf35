"""imuwb catalog: a row for each recording, every string escaped; files that say nothing are rows that say why."""

import re
import socket
import subprocess
import sys
import time
from html.parser import HTMLParser

import pytest
import rerun as rr

from imuwb.review.page.catalog import entries
from imuwb.review.recording.review import RecordingReview

HOSTILE = '"><script>alert(1)</script><img src=x onerror=alert(2)>\u2028\x1b[2J'


@pytest.fixture
def folder(tmp_path):
    """Return a folder of a recording with hostile texts, a foreign one, a damaged one, and a page."""
    home = tmp_path / "runs"
    home.mkdir()
    review = RecordingReview(home / "a b&<i>.rrd")
    stated = {"analysis": "noise", "log": ["one.csv", HOSTILE], "verdict": HOSTILE, "headline": "N 2.4", "level": 0.95,
              "N [deg/√h]": 2.4, "N interval [deg/√h]": [2.3, 2.5], HOSTILE: 7}  # fmt: skip
    review.state(HOSTILE, stated, "{}")
    whole = review.close().read_bytes()
    (home / "a b&<i>.html").touch()
    (home / "cut.rrd").write_bytes(whole[:-50])
    (home / "notes.txt").touch()
    foreign = rr.RecordingStream("other")
    foreign.save(home / "foreign.rrd")
    foreign.send_recording_name("theirs")
    foreign.disconnect()
    return home


class Tags(HTMLParser):
    def __init__(self, text) -> None:
        super().__init__()
        self.tags, self.links = [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.links += [value for name, value in attributes if name in ("href", "src")]
        assert not any(name.startswith("on") for name, _ in attributes)


def test_a_page_has_a_row_for_each_recording_and_no_string_is_markup(folder, imuwb):
    done = imuwb("catalog", folder)
    assert done.code == 0
    assert "3 recordings" in done.out
    assert "2 recordings without a result" in done.out
    text = (folder / "index.html").read_text("utf-8")
    page = Tags(text)
    assert page.tags.count("script") == 1
    assert "img" not in page.tags
    assert page.links == ["./a%20b%26%3Ci%3E.rrd", "./a%20b%26%3Ci%3E.html", "./cut.rrd", "./foreign.rrd"]
    assert "default-src 'none'" in text
    assert not {"\u2028", "\x1b"} & set(text)
    assert page.tags.count("tr") == 4
    assert "2.4 [2.3, 2.5]" in text
    again = imuwb("catalog", folder)
    assert again.code == 2
    assert "--force" in again.err
    assert imuwb("catalog", folder, "--force").code == 0


def test_links_are_relative_to_the_page(folder, tmp_path, imuwb):
    assert imuwb("catalog", folder, "-o", tmp_path / "all.html").code == 0
    assert "./runs/cut.rrd" in Tags((tmp_path / "all.html").read_text("utf-8")).links


def test_rows_say_why_they_say_nothing(folder):
    whole, cut, foreign = entries(folder, folder / "index.html")
    assert whole.cells[:2] == ("noise", "one.csv, " + whole.cells[4])
    assert (cut.name, foreign.name) == ("", "theirs")
    assert "no whole recording" in cut.remark
    assert "not a result of imuwb" in foreign.remark


@pytest.mark.parametrize(
    ("arguments", "code", "text"),
    [(["gone"], 4, "gone: No such file"), (["empty"], 3, "no recording"), (["empty/file"], 4, "give a folder"),
     (["runs", "-o", "page.txt"], 2, ".html"), (["runs", "--serve", "--port", "0"], 2, "--port is 0"),
     (["runs", "--serve", "-o", "x.html"], 2, "writes no page")],
)  # fmt: skip
def test_what_cannot_be_done_is_said_in_a_sentence(arguments, code, text, folder, tmp_path, imuwb):
    (tmp_path / "empty").mkdir()
    (tmp_path / "empty" / "file").touch()
    done = imuwb("catalog", *arguments)
    assert done.code == code
    assert text in done.err
    assert not list(folder.glob("index.html"))


@pytest.mark.slow
def test_a_served_catalog_listens_on_this_machine_only(folder):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    command = [sys.executable, "-m", "imuwb", "catalog", str(folder), "--serve", "--port", str(port)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True) as server:
        try:
            said = server.stderr.readline()
            assert re.search(rf"127\.0\.0\.1:{port}", said)
            for _ in range(200):
                with socket.socket() as client:
                    if client.connect_ex(("127.0.0.1", port)) == 0:
                        break
                time.sleep(0.1)
            else:
                pytest.fail("the server does not listen")
            with socket.socket() as other:
                assert other.connect_ex(("127.0.0.2", port)) != 0
        finally:
            server.terminate()
            server.wait()
    with socket.socket() as client:
        assert client.connect_ex(("127.0.0.1", port)) != 0  # the server has ended with the command

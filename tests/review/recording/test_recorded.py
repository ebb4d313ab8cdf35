"""What a recording contains besides its tabs is read as it was written; other files are refused with a sentence."""

import json
import os
import random

import pytest
import rerun as rr

from imuwb.errors import UnreadableLogError
from imuwb.readers.bytes import budget
from imuwb.review.recording.recorded import compact, read

DOCUMENT = {
    "value": 0.1234567890123,
    "time": 1_700_000_000.123456789,
    "count": 123_456_789_012,
    "rows": [None, "°", True],
}


@pytest.fixture
def written(review):
    """Return a recording with a name, properties and a document."""
    properties = {"sensor": ["/imu"], "log": ["a.csv", "b.csv"], "N [deg/√h]": 2.4, "interval": [2.3, 2.5], "count": 3}
    review.review.note("a note")
    review.review.state("noise · a.csv", properties, json.dumps(DOCUMENT))
    return review.review.close()


def test_what_is_written_is_read(written):
    recorded = read(written)
    assert recorded.name == "noise · a.csv"
    assert recorded.properties == {
        "sensor": "/imu", "log": ["a.csv", "b.csv"], "N [deg/√h]": 2.4, "interval": [2.3, 2.5], "count": 3
    }  # fmt: skip
    assert not recorded.foreign
    assert recorded.document() == {**DOCUMENT, "value": 0.1234568}


def test_a_document_keeps_seven_digits_and_times_since_1970_keep_all():
    assert json.loads(compact(json.dumps(DOCUMENT))) == {**DOCUMENT, "value": 0.1234568}
    assert " " not in compact(json.dumps(DOCUMENT, indent=1))
    assert json.loads(compact(json.dumps([0.123456789] * 17))) == [0.12346] * 17  # a curve
    assert json.loads(compact(json.dumps([0.123456789] * 16))) == [0.1234568] * 16


def test_a_recording_of_another_program_has_no_properties(tmp_path):
    other = rr.RecordingStream("other")
    other.save(tmp_path / "other.rrd")
    other.send_recording_name("theirs")
    other.log("x", rr.Scalars(1.0))
    other.disconnect()
    recorded = read(tmp_path / "other.rrd")
    assert (recorded.name, recorded.foreign, recorded.document()) == ("theirs", True, None)


@pytest.mark.parametrize("damage", [lambda d: d[:0], lambda d: d[4:], lambda d: d[:-9], lambda d: d[:4] + os.urandom(200) + d[204:], lambda d: d[:700] + os.urandom(800) + d[1500:]])  # fmt: skip
def test_a_damaged_recording_is_refused_with_its_name(damage, written):
    written.write_bytes(damage(written.read_bytes()))
    with pytest.raises(UnreadableLogError, match=r"r\.rrd: .*(damaged|no whole recording)"):
        read(written)


def test_a_recording_that_unpacks_to_much_is_refused(review, tmp_path, monkeypatch):
    review.review.keep("page", "x" * (4 << 20))
    place = review.review.close()
    assert len(read(place).texts["page"]) == 4 << 20
    monkeypatch.setattr(budget, "CONSTANT", 1 << 16)
    with pytest.raises(UnreadableLogError, match="text in it would take"):
        read(place)


def test_damage_anywhere_ends_in_an_error_of_ours(written):
    """The viewer's own library ends the process at some of these recordings."""
    sound, rng = written.read_bytes(), random.Random(1)  # noqa: S311 - the same damage each time
    refused = 0
    for _ in range(150):
        data = bytearray(sound)
        at = rng.randrange(4, len(data) - 12)
        data[at : at + 8] = rng.choice((bytes(8), b"\xff" * 8, (1 << 40).to_bytes(8, "little"), rng.randbytes(8)))
        written.write_bytes(data)
        try:
            read(written).document()
        except UnreadableLogError:
            refused += 1
    assert 20 < refused < 140


@pytest.mark.parametrize("text", ["[" * 100_000, "[1]", "{"])
def test_a_document_that_is_no_json_is_refused(review, text):
    review.review.keep("document", text)
    with pytest.raises(UnreadableLogError, match="JSON of its result"):
        read(review.review.close()).document()


def test_a_file_that_is_absent_or_a_folder_is_refused(tmp_path):
    for path in (tmp_path / "no.rrd", tmp_path):
        with pytest.raises(UnreadableLogError, match="cannot be read"):
            read(path)

import copy
import pickle

import pytest

from imuwb.notes import Note, ids

NOTE = Note("moving", "the log moves in its first second")


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, lambda note: pickle.loads(pickle.dumps(note))])  # noqa: S301 - written on the spot
def test_a_copy_of_a_note_has_its_id(copied):
    """Studies pass results with notes between processes."""
    note = copied(NOTE)
    assert (note, note.id, type(note)) == (str(NOTE), "moving", Note)


def test_plain_texts_have_no_id():
    assert ids(["a text", NOTE]) == ("moving",)

from pathlib import Path


def test_the_command_explains_lists_and_offers(imuwb):
    assert "0.664" in imuwb("explain", "bias", "instability").out
    assert "clock jump" in imuwb("explain").out
    wrong = imuwb("explain", "clok", "jump")
    assert (wrong.code, "clock jump" in wrong.err) == (2, True)


def test_full_names_the_places_of_its_notes_and_verdicts(imuwb, static_mcap, monkeypatch):
    monkeypatch.syspath_prepend(Path(__file__).parents[2] / "docs")
    from making.notes import notes

    done = imuwb("psd", static_mcap, "--full", COLUMNS="4000")
    (line,) = [line for line in done.err.splitlines() if "#note-ID" in line]
    said = line.rpartition(": ")[2].split(", ")
    known = notes()
    assert said
    assert set(said) <= set(known), said
    assert len(known) > 200


def test_the_page_of_notes_has_an_anchor_for_each(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(Path(__file__).parents[2] / "docs")
    from making import notes

    notes.make(tmp_path)
    page = (tmp_path / "index.md").read_text("utf-8")
    anchors = [line for line in page.splitlines() if line.startswith("(note-")]
    assert len(anchors) == len(set(anchors)) == len(notes.notes())

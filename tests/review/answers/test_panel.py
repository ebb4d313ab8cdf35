import pytest

from imuwb.analysis import Answer, Step, Table
from imuwb.log import Log, Provenance
from imuwb.names import shortened
from imuwb.review.answers.default_answer import default_answer
from imuwb.review.answers.panel import HEIGHT, WIDTH, Origin, panel

ROWS = tuple((f"gyro {axis}", "2.40 [2.38, 2.43]", "40 [32, 47]", "yes") for axis in "xyz")
ANSWER = Answer(
    "1 h still, 20 Hz", ("", "N", "B", "trust"), ROWS, ("Trust them.",),
    (Step("imuwb outage DRIVE --error-model {model}", "how far a drive drifts"),), "95 % intervals",
)  # fmt: skip
ORIGIN = Origin("noise", ("logs/static.mcap",), "static.error-model.toml", ("static.rrd (imuwb view)",))


def test_the_answer_comes_first_and_the_files_last():
    lines = panel(ANSWER, ORIGIN)
    assert lines[0].startswith("NOISE  static.mcap: 1 h still, 20 Hz")
    assert lines[0].endswith("95 % intervals")
    assert len(lines[0]) == WIDTH
    assert lines[-1].split() == ["Wrote", "static.rrd", "(imuwb", "view)"]
    assert any("--error-model static.error-model.toml" in line for line in lines)
    # Columns are aligned.
    assert {line.index("2.40") for line in lines if "2.40" in line} == {lines[1].index("N")}


@pytest.mark.parametrize("width", [60, 80, 100])
@pytest.mark.parametrize("rows", [0, 3, 40])
@pytest.mark.parametrize("words", [1, 400])
def test_no_panel_is_larger_than_its_screen(width, rows, words):
    answer = Answer(
        "x" * 90,
        ("a", "b"),
        ((("cell " * 9).strip(), "other " * 9),) * rows,
        ("word " * words,) * 3,
        ANSWER.next * 4,
        "aside",
    )
    lines = panel(answer, ORIGIN, width)
    assert len(lines) <= HEIGHT
    commands = [line for line in lines if "imuwb" in line]
    assert all(len(line) <= width for line in lines if line not in commands)
    assert len(commands) >= 2  # the next command and what was written are always there
    if rows and words > 1:
        assert sum("word" in line for line in lines) >= 2  # a long table leaves room for what to believe


def test_headings_without_a_row_are_not_shown():
    lines = panel(Answer("none", ("axis", "line", "amplitude"), sentences=("No line.",)), ORIGIN)
    assert not any("amplitude" in line for line in lines)


def test_what_is_left_out_shows_at_the_end_of_the_last_line():
    lines = panel(Answer("many", ("a",), tuple((f"row {i}",) for i in range(40))), ORIGIN)
    assert lines[-2].endswith("…")
    assert "row 0" in lines[2]


def test_names_are_shortened_in_the_middle():
    assert shortened("short.mcap", 20) == "short.mcap"
    text = shortened("a_very_long_name_of_a_drive_2024-05-01.mcap", 20)
    assert len(text) == 20
    assert text.startswith("a_ver")
    assert text.endswith("05-01.mcap")


def test_several_logs_are_counted_and_paths_with_blanks_are_quoted():
    step = Step("imuwb lssa {log}", "why")
    lines = panel(Answer("two", next=(step,)), Origin("noise", ("my logs/a.csv", "b.csv")))
    assert lines[0].startswith("NOISE  a.csv and 1 more: two")
    assert 'imuwb lssa "my logs/a.csv" b.csv' in lines[1]


def test_no_text_of_a_log_reaches_the_terminal_as_a_command():
    answer = Answer("a \x1b]52;c;ZXZpbA==\x07 b", ("\x1b[2J",), (("\udce9", "\x00"),), ("bell \x07",))
    text = "".join(panel(answer, Origin("noise", ("\x1b[31mlog\udce9.csv",))))
    assert text.isprintable()
    text.encode("utf-8")


def test_a_row_of_the_table_counts_for_more_than_the_reason_of_a_command():
    """The last row may be that of the units."""
    answer = Answer(
        "x",
        ("a",),
        tuple((f"row {i}",) for i in range(8)),
        ("Trust them.", "They are still."),
        (Step(f"imuwb {'lssa ' * 9}", "what shakes it " * 3),) * 2,
    )
    lines = panel(answer, Origin("noise", ("a.mcap",), "", ("folder/" * 9, "other/" * 9)))
    assert len(lines) == HEIGHT
    assert any("row 7" in line for line in lines)
    assert not any("…" in line for line in lines)


@pytest.mark.parametrize(("rows", "notes", "more"), [(3, 1, False), (9, 1, True), (3, 4, True), (0, 0, False)])
def test_the_answer_of_a_plugin_that_states_none_names_the_way_to_the_rest(rows, notes, more):
    log = Log(Provenance("made", "csv", "", 0))
    table = [Table("T", ("a", "b"), (("1", "2"),) * rows)] if rows else []
    answer = default_answer([log], [*table, *("note",) * notes])
    assert (len(answer.rows), len(answer.sentences)) == (min(rows, 8), min(notes, 3))
    assert bool(answer.next) == more
    lines = panel(answer, Origin("mine", ("a.csv",), command="imuwb ./mine.py a.csv --force"))
    assert any(line.startswith("Next   imuwb ./mine.py a.csv --force --full") for line in lines) == more


def test_a_narrow_screen_shows_each_row_as_a_sentence_and_cuts_nothing():
    lines = panel(ANSWER, ORIGIN, 40)
    assert all(len(line) <= 40 for line in lines if "imuwb" not in line)
    text = " ".join(lines)
    for part in ("gyro z: N 2.40 [2.38, 2.43]", "trust yes", "95 % intervals", "Trust them."):
        assert part in " ".join(text.split())
    assert "…" not in text


def test_the_next_command_says_how_the_log_is_read():
    step = Step("imuwb lssa {log}", "why")
    lines = panel(Answer("x", next=(step,)), Origin("noise", ("a.csv",), options=("--rate", "100")))
    assert lines[1].startswith("Next   imuwb lssa a.csv --rate 100")

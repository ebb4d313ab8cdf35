"""Tables and notes in the terminal."""

import io
import sys

import pytest

from imuwb.analysis import Table
from imuwb.cli.terminal import progress, shower


def test_headings_keep_their_units(capsys):
    shower(data=True)(Table("T [s]", ("N x [deg/√h]", "sigma"), (("1 [0.9, 1.1]", "2"),)))
    assert "N x [deg/√h]" in capsys.readouterr().out


@pytest.mark.parametrize("data", [True, False])
def test_notes_go_to_stderr_and_tables_to_stdout_if_they_are_data(data, capsys):
    show = shower(data=data)
    show("a [note]")
    show(Table("T", ("a",), (("cell",),)))
    out, err = capsys.readouterr()
    assert "a [note]" in err
    assert ("cell" in out) == data
    assert ("cell" in err) != data


def test_a_pipe_has_200_columns(capsys):
    shower(data=True)(Table("T", ("a",), (("word " * 60,),)))
    assert max(len(line) for line in capsys.readouterr().out.splitlines()) == 200


def test_a_value_and_its_unit_stay_on_one_line(capsys):
    shower(data=True)(Table("T", ("a", "b"), (("1.5 m", "1 [0, 2] deg/h"),)))
    out = capsys.readouterr().out
    assert "1.5\N{NO-BREAK SPACE}m" in out
    assert "2]\N{NO-BREAK SPACE}deg/h" in out


def test_a_name_in_a_bar_of_progress_does_nothing(monkeypatch):
    class Terminal(io.StringIO):
        def isatty(self):
            return True

    monkeypatch.setattr(sys, "stderr", shown := Terminal())
    monkeypatch.setenv("TERM", "xterm")
    with progress("reading \x1b]52;c;aGk=\x07[red]a[/]\u202e.mcap") as report:
        report(1, 2)
    assert "reading ?]52;c;aGk=?[red]a[/]?.mcap" in shown.getvalue()
    assert "\x1b]52" not in shown.getvalue()

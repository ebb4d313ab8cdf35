"""Tables and notes in the terminal."""

import pytest

from imuwb.analysis import Table
from imuwb.cli.terminal import shower


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

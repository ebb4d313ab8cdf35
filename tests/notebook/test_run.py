"""imuwb.run: what the command line does, without a file unless the result is saved."""

import ast
import json
import sys
from pathlib import Path

import pytest

import imuwb
from imuwb.analysis import Table
from imuwb.cli import main
from imuwb.errors import MissingDataError, UsageError
from imuwb.notebook.run import _command
from imuwb.notebook.shown import TableFrame
from imuwb.review.recording.rrd import is_whole
from imuwb.review.tables.files import csv_text
from imuwb.simulation import preset, static
from imuwb.writers import write

SAMPLES = Path(__file__).parents[2] / "samples"
PLUGIN = '''"""Jerk: how fast the specific force changes."""
from dataclasses import dataclass
from typing import Annotated, Literal
import numpy as np
from imuwb.analysis import Curve, Figure, Table

@dataclass(frozen=True)
class Parameters:
    axis: Annotated[Literal["x", "y", "z"], "of the accelerometer"] = "z"
    shares: tuple[float, ...] = (0.5, 0.1)

def run(logs, parameters):
    force = logs[0].imu().specific_force
    jerk = np.abs(np.diff(force.value[:, "xyz".index(parameters.axis)])) / np.diff(force.time) * 1e9
    shares = np.array(parameters.shares)
    return {"count": jerk.size, "share": shares, "jerk": np.quantile(jerk, 1 - shares)}

def draw(result, review):
    review.figure(Figure("Jerk", "share [1]", "exceeded jerk [m/s³]", (Curve("jerk", result["share"], result["jerk"], (76, 120, 168)),)))
    rows = tuple((f"{100 * s:g} %", f"{j:.3g} m/s³") for s, j in zip(result["share"], result["jerk"]))
    review.table(Table("Jerk", ("share of samples", "exceeds"), rows))
    review.note("a note <b>")
'''


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Return the working folder, with a log and the file of a plugin."""
    monkeypatch.chdir(tmp_path)
    write(static(preset("3dm-gx3-25"), 20, 50, 1), tmp_path / "static.mcap")
    (tmp_path / "jerk.py").write_text(PLUGIN, "utf-8")
    return tmp_path


def names(folder):
    return {path.name for path in folder.iterdir() if path.name != "__pycache__"}


@pytest.fixture
def found(folder):
    return imuwb.run("jerk.py", "static.mcap", start=5, through="bandwidth:cutoff=10", shares=[0.5, 0.2])


def test_it_is_what_the_command_line_gives(folder, found, monkeypatch, capsys):
    assert names(folder) == {"static.mcap", "jerk.py"}
    words = ["jerk.py", "static.mcap", "--start", "5", "--through", "bandwidth:cutoff=10", "--shares", "0.5,0.2"]
    monkeypatch.setattr(sys, "argv", ["imuwb", *words, "--json", "own.json", "-o", "own.rrd"])
    with pytest.raises(SystemExit, match="^0$"):
        main()
    out = capsys.readouterr().out
    assert found.document == json.loads((folder / "own.json").read_text("utf-8"))
    assert found.save("mine.rrd") == Path("mine.rrd")
    drop = ("Next", "Wrote", "      ")
    assert [x for x in repr(found).splitlines() if not x.startswith(drop)] == [
        x for x in out.splitlines() if not x.startswith(drop)
    ]
    assert found.result["count"] == found.document["result"]["count"] > 700
    assert found.logs[0].conditioning[0].name == "bandwidth"
    assert _command("jerk.py", ["a b.mcap"], {"start": 5, "shares": [0.5, 0.2], "join": ["x", "y"], "even": True}) == (
        "imuwb jerk.py 'a b.mcap' --start 5 --shares 0.5,0.2 --join x --join y --even"
    )


def test_it_shows_itself_and_gives_what_it_shows(found):
    page = found._repr_html_()
    assert found.answer.figure.title == "Jerk"  # and not the first figure, which is the conditioner's
    assert "Jerk" in page
    assert "<svg" in page
    assert "<script" not in page
    figure = next(figure for figure in found.figures if figure.title == "Jerk")
    assert "<svg" in figure._repr_svg_()
    assert repr(figure) == "<Figure: Jerk>"
    table = next(table for table in found.tables if table.table.title == "Jerk")
    assert table.columns["share of samples [%]"] == [50.0, 20.0]
    assert table.to_arrow().num_rows == 2
    assert "<th>exceeds</th>" in table._repr_html_()
    assert "a note <b>" in found.notes


def test_a_table_keeps_the_units_that_differ_in_a_column_and_has_the_columns_of_its_csv():
    table = TableFrame(Table("N", ("axis", "N"), (("gyro", "2 [1, 3] deg/√h"), ("accel", "< 4 m/s/√h"))))
    assert table.title == "N"
    assert table.columns["N unit"] == ["deg/√h", "m/s/√h"]
    assert table.columns["N upper"] == [3.0, 4.0]
    assert ",".join(table.columns) == csv_text(table.table).splitlines()[0]


def test_it_is_saved_by_suffix(folder, found):
    for name in ("a.rrd", "a.html", "a.json"):
        found.save(name)
    assert is_whole("a.rrd")
    assert (folder / "a.html").read_text("utf-8").startswith("<!doctype html>")
    assert json.loads((folder / "a.json").read_text("utf-8")) == found.document
    with pytest.raises(UsageError, match=r"a\.json exists; overwrite it with force=True"):
        found.save("a.json")
    found.save("a.json", force=True)
    with pytest.raises(UsageError, match=r"\.rrd, \.html, \.pdf, \.json, \.toml"):
        found.save("a.png")
    with pytest.raises(UsageError, match="identifies no error model"):
        found.save("a.toml")
    assert names(folder) == {"static.mcap", "jerk.py", "a.rrd", "a.html", "a.json"}


@pytest.mark.parametrize(
    ("analysis", "options", "words"),
    [
        ("nope", {}, "there is no analysis 'nope'; there are allan"),
        ("calibration", {}, "write calibration six-position"),
        ("noise x", {}, "write noise"),
        ("jerk.py", {"axes": "x"}, "jerk.py has no option axes; the options are axis, columns"),
        ("jerk.py", {"html": "x.html"}, "imuwb.run writes no file; use save"),
        ("jerk.py", {"axis": "w"}, "axis is 'w'; it must be x or y or z"),
        ("jerk.py", {"rate": -1}, "rate is -1"),
        ("jerk.py", {"through": "nope"}, "there is no such conditioner"),
        ("jerk.py", {"imu": "all"}, "jerk analyses one IMU"),
    ],
)
@pytest.mark.usefixtures("folder")
def test_wrong_usage_is_named(analysis, options, words):
    with pytest.raises(UsageError, match=words.replace(".", r"\.")):
        imuwb.run(analysis, "static.mcap", **options)


def test_it_needs_a_log():
    with pytest.raises(UsageError, match="no log is given"):
        imuwb.run("noise")


MODEL = """
from imuwb.simulation import preset

def error_model(result):
    return preset("mpu-6050")

def objections(result):
    return ("the record moves",)
"""


def test_a_model_of_a_record_that_does_not_suit_one_is_written_if_forced(folder):
    (folder / "model.py").write_text(PLUGIN + MODEL, "utf-8")
    found = imuwb.run("model.py", "static.mcap")
    with pytest.raises(MissingDataError, match="the record moves.*force_model=True"):
        found.save("m.toml")
    found.save("m.toml", force_model=True)
    model = imuwb.ImuErrorModel.from_toml((folder / "m.toml").read_text("utf-8"))
    assert model.provenance["run"] == found.document["run"]


@pytest.mark.slow
def test_the_notebook_of_the_samples_runs_and_each_result_shows_itself(monkeypatch):
    monkeypatch.chdir(SAMPLES)
    before = names(SAMPLES)
    cells = json.loads((SAMPLES / "notebook.ipynb").read_text("utf-8"))["cells"]
    space, shown = {}, []
    for cell in (cell for cell in cells if cell["cell_type"] == "code"):
        *body, last = ast.parse("".join(cell["source"])).body
        exec(compile(ast.Module(body, []), "cell", "exec"), space)  # noqa: S102 - our own notebook
        if isinstance(last, ast.Expr):
            value = eval(compile(ast.Expression(last.value), "cell", "eval"), space)  # noqa: S307
            how = next(h for h in ("_repr_html_", "_repr_svg_", "__repr__") if hasattr(value, h))
            shown.append((how, getattr(value, how)()))
    assert [how for how, _ in shown] == ["_repr_html_", "__repr__", "_repr_html_", "_repr_svg_", "_repr_html_"]
    assert all("deg/√h" in text for _, text in shown[:2])
    assert "15AV" in shown[-1][1]
    assert names(SAMPLES) == before

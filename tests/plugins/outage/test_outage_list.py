"""Outages from a file: their names, the log they belong to, and what is no such file."""

import json
from pathlib import Path

import pytest

from imuwb.errors import UsageError
from imuwb.log import Log, Provenance
from imuwb_plugins.outage import Parameters
from imuwb_plugins.outage.given_outages import name_of, outages_of
from imuwb_plugins.outage.outage_list import OutageFile, given

from .made import KNOWN

CSV = "name,start,duration,log\ntunnel,130,10,\nbridge,150.5,10,other\n"
TOML = '[[outage]]\nname = "tunnel"\nstart = 130\nduration = 10\n\n[[outage]]\nstart = 150.5\nduration = 10\nlog = "other"\n'


def named(path):
    return Log(Provenance(path, "made", "", 0))


@pytest.fixture
def file(tmp_path):
    def write(text, name="o.csv"):
        (tmp_path / name).write_text(text, "utf-8")
        return str(tmp_path / name)

    return write


@pytest.mark.parametrize(
    ("text", "name"), [(CSV, "o.csv"), (TOML, "o.toml"), ("# list\n" + CSV.replace(",", ";"), "o.csv")]
)
def test_a_file_of_outages(file, text, name):
    at = Parameters(at=file(text, name)).at
    first, second = given(at)
    assert (first.start, first.duration, first.name, first.log) == (130.0, 10.0, "tunnel", "")
    assert (second.start, second.log) == (150.5, "other")
    assert [o.name for o in outages_of(named("/a/drive.csv.gz"), at)] == ["tunnel"]
    assert [o.start for o in outages_of(named("other.mcap"), at)] == [130.0, 150.5]


def test_outages_keep_their_table(file):
    at = Parameters(at=file("name,start,duration,table\na,130,10,9\nb,150,10,\n")).at
    assert [o.table for o in outages_of(named("x.mcap"), at)] == ["9", ""]


def test_pairs_of_the_command_line_have_no_name():
    (one,) = outages_of(named("x.mcap"), Parameters(at="130:10,130:10").at)
    assert (one.start, one.duration, one.name) == (130.0, 10.0, "")
    assert name_of(named("a/b.csv.gz")) == "b"


def test_a_log_without_an_outage_is_said(file):
    with pytest.raises(UsageError, match="'drive'"):
        outages_of(named("drive.mcap"), Parameters(at=file("start_s,duration_s,log\n1,10,x\n")).at)


@pytest.mark.parametrize(
    ("text", "name", "words"),
    [
        ("name,begin\na,1\n", "o.csv", "its columns are name, begin"),
        ("", "o.csv", "its columns are none"),
        ("start,duration\n", "o.csv", "0 outages"),
        ("start,duration\n1,x\n", "o.csv", "outage 1: duration is 'x'"),
        ("start,duration\n1\n", "o.csv", "outage 1: duration is None"),
        ("start,duration\nnan,3\n", "o.csv", "must be finite"),
        ("start,duration\n" + "1,10\n" * 10_001, "o.csv", "10001 outages"),
        ("[[outage]]\nstart = 1\n", "o.toml", "duration is None"),
        ("[[outage]]\nbegin = 1\n", "o.toml", "start and duration"),
        ("[outage]\nstart = 1\n", "o.toml", r"\[\[outage\]\]"),
        ("= 3", "o.toml", "not TOML"),
    ],
)
def test_what_is_no_file_of_outages(file, text, name, words):
    with pytest.raises(UsageError, match=words):
        Parameters(at=file(text, name))


def test_faults_of_files(tmp_path):
    with pytest.raises(UsageError, match="cannot be read"):
        OutageFile.from_text(str(tmp_path / "none.csv"))
    (tmp_path / "b.csv").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(UsageError, match="UTF-8"):
        OutageFile.from_text(str(tmp_path / "b.csv"))
    with pytest.raises(ValueError, match=r"at is '200;30'; it must be own or .*A:B"):
        Parameters(at="200;30")
    (tmp_path / "s.csv").write_text("start,duration\n100,1\n", "utf-8")
    with pytest.raises(ValueError, match="an outage lasts 1 s"):
        Parameters(at=str(tmp_path / "s.csv"))


def test_the_name_is_in_the_result(command, mcap, toml):
    Path("o.csv").write_text("name,start,duration\ntunnel,150,10\n", "utf-8")
    code, out, err = command(
        "outage",
        mcap,
        "--error-model",
        toml,
        "--models",
        "none",
        "--at",
        "o.csv",
        "-o",
        "o.rrd",
        "--json",
        "o.json",
        "--full",
        *KNOWN,
    )
    assert code == 0, err
    assert "tunnel" in out
    content = json.loads(Path("o.json").read_text("utf-8"))
    assert content["result"]["outages"][0]["name"] == "tunnel"
    code, _, err = command("outage", mcap, "--error-model", toml, "--at", "no.csv", "-o", "p.rrd")
    assert (code, "--at no.csv" in err) == (2, True)

"""Several drives in one call: each alone and pooled."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from imuwb.errors import MissingDataError, UsageError
from imuwb.log import Provenance
from imuwb.notes import ids
from imuwb.simulation import drive, mixed_route
from imuwb.writers import write
from imuwb_plugins import outage

from .made import KNOWN, Shown, sensor, stated

pytestmark = pytest.mark.slow


#: what would else be estimated, for seconds


def named(log, path):
    return replace(log, provenance=replace(log.provenance, path=path))


@pytest.fixture(scope="module")
def two(log):
    return [named(log, "/a/north.mcap"), named(drive(sensor(), mixed_route(240, 4), 2, rate=50.0), "/a/south.csv.gz")]


@pytest.fixture(scope="module")
def options(toml):
    return {"error_model": toml, "models": "none,full", "durations": "5", "settling": 40.0}


@pytest.fixture(scope="module")
def both(two, options):
    return outage.run(two, stated(**options))


def test_each_alone_and_all_pooled(two, options, both):
    assert list(both.drives) == ["north", "south"]
    alone = [outage.run([log], stated(**options)).summary[0].models for log in two]
    (own,) = both.pooled
    for name in ("none", "full"):
        assert own.models[name].count == sum(one[name].count for one in alone)
        assert own.models[name].effective_count == sum(one[name].effective_count for one in alone)
        low, high = sorted(one[name].median_end for one in alone)
        assert low <= own.models[name].median_end <= high
        assert both.drives["south"].summary[0].models[name].median_end == alone[1][name].median_end
    assert own.paired
    assert own.by_motion
    assert "pooled" in ids(both.notes)
    assert len(both.verdicts) == 2


def test_what_is_drawn(both):
    shown = Shown()
    outage.draw(both, shown)
    assert shown.tables[0].title == "Drift after 5 s without GNSS, all drives"
    by_drive = shown.tables[1]
    assert [row[:2] for row in by_drive.rows] == [
        ("north", "none"), ("north", "full"), ("south", "none"), ("south", "full"),
    ]  # fmt: skip
    assert {"north", "south", "Consistency"} <= set(shown.tabs)


def test_a_drive_that_cannot_be_replayed_does_not_end_the_others(two, options):
    found = outage.run([two[0], named(replace(two[1], gnss=()), "/a/bare.mcap")], stated(**options))
    assert list(found.drives) == ["north"]
    assert "no GNSS receiver" in found.failed["bare"]
    assert "drive-left-out" in ids(found.notes)
    with pytest.raises(MissingDataError, match="no drive can be replayed"):
        outage.run([replace(log, gnss=()) for log in two], stated(**options))


def test_equal_names_get_a_number(two, options):
    same = [two[0], replace(two[1], provenance=Provenance("/b/north.bin", "made", "", 0))]
    assert list(outage.run(same, stated(**options)).drives) == ["north 1", "north 2"]


def test_outages_of_a_file_belong_to_their_log(two, toml, tmp_path):
    (tmp_path / "o.csv").write_text("name,start,duration,log\na,150,10,north\nb,160,10,south\nc,180,10,\n", "utf-8")
    found = outage.run(two, stated(error_model=toml, models="none", at=str(tmp_path / "o.csv")))
    names = {name: [o.name for o in one.outages] for name, one in found.drives.items()}
    assert names == {"north": ["a", "c"], "south": ["b", "c"]}
    (tmp_path / "p.csv").write_text("start,duration,log\n150,10,west\n", "utf-8")
    with pytest.raises(UsageError, match="there is no log 'west'; the logs are north, south"):
        outage.run(two, stated(error_model=toml, models="none", at=str(tmp_path / "p.csv")))


def test_each_log_has_its_own_truth(two, toml, tmp_path):
    for log, name in zip(two, ("north", "south"), strict=True):
        write(replace(log, imus=(), gnss=()), tmp_path / f"{name}.mcap")
    found = outage.run(
        [replace(log, references=()) for log in two],
        stated(error_model=toml, models="none", at="150:10", truth=tmp_path / "{log}.mcap"),
    )
    assert [one.reference for one in found.drives.values()] == ["truth of north.mcap", "truth of south.mcap"]


def test_files_of_one_run_need_one_log(two, options):
    with pytest.raises(UsageError, match="--navigation writes the run of one log; 2 logs"):
        outage.run(two, stated(**options, navigation="n.csv"))


def test_the_command(command, mcap, toml, log):
    write(log, "second.mcap")
    code, out, err = command(
        "outage", mcap, "second.mcap", "--error-model", toml, "--models", "none", "--at", "150:10,165:10", *KNOWN, "-o", "o.rrd",
        "--json", "o.json", "--full",
    )  # fmt: skip
    assert code == 0, err
    assert "all drives" in out
    content = json.loads(Path("o.json").read_text("utf-8"), parse_constant=pytest.fail)
    assert content["result"]["pooled"][0]["models"]["none"]["count"] == 4
    assert list(content["result"]["drives"]) == ["drive", "second"]

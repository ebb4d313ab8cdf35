"""Where outputs go: the default names, and the rules that are checked before the work."""

from pathlib import Path
from types import SimpleNamespace

import pytest

from imuwb.cli.options import Outputs
from imuwb.cli.places import Places, check_places, stem
from imuwb.errors import ImuwbError, UsageError

BARE = SimpleNamespace()


@pytest.mark.parametrize(
    ("name", "expected"),
    [("static.csv.gz", "static"), ("a.b.mcap", "a.b"), ("run.pos", "run"), ("flight.tlog", "flight"), ("log.ulg", "log"),
     ("00000012.bin", "00000012"), ("dump.log", "dump"), ("notes.txt", "notes"), ("r.rrd", "r"), (".csv", ".csv"), ("data.dat", "data.dat")],
)  # fmt: skip
def test_the_suffixes_of_logs_are_taken_off(name, expected):
    assert stem(Path("folder") / name) == expected


def test_defaults_are_beside_the_first_log():
    places = Places.of("noise", BARE, [Path("x/a.csv.gz"), Path("y/b.csv")], Outputs(), None)
    assert places == Places(Path("x/a.rrd"), None, None, to_stdout=False)
    assert places.all() == [Path("x/a.rrd")]


@pytest.mark.parametrize(
    ("mark", "name"), [(True, "r.error-model.toml"), ("temperature", "r.temperature.toml"), (False, None)]
)
def test_an_analysis_that_leaves_a_model_has_a_place_for_it(mark, name):
    outputs = Outputs(output=Path("x/r.rrd"))
    model = Places.of("noise", SimpleNamespace(LEAVES_MODEL=mark), [Path("a.csv")], outputs, None).model
    assert model == (None if name is None else Path("x") / name)


def test_json_goes_to_stdout_or_to_a_file():
    assert Places.of("noise", BARE, [Path("a.csv")], Outputs(json="-"), None).to_stdout
    assert Places.of("noise", BARE, [Path("a.csv")], Outputs(json="a.json"), None).document == Path("a.json")


def test_files_of_an_analysis_are_among_the_outputs():
    analysis = SimpleNamespace(outputs=lambda parameters: (Path(parameters),))
    assert Places.of("noise", analysis, [Path("a.csv")], Outputs(), "own.txt").all() == [Path("a.rrd"), Path("own.txt")]


def test_a_recording_must_be_an_rrd_file():
    with pytest.raises(UsageError, match=r"x\.mcap.*\.rrd"):
        Places.of("noise", BARE, [Path("a.csv")], Outputs(output=Path("x.mcap")), None)


@pytest.mark.parametrize(
    "wrong", [{"json": "a.html"}, {"json": "a.rrd"}, {"save_model": Path("m.json")}, {"html": Path("a.txt")}, {"pdf": Path("a.html")}]
)  # fmt: skip
def test_a_file_has_the_suffix_of_what_it_contains(wrong):
    with pytest.raises(UsageError, match="suffix of another output|must end in"):
        Places.of("noise", BARE, [Path("a.csv")], Outputs(**wrong), None)


def test_outputs_differ_from_each_other_and_from_the_logs(tmp_path):
    first, second, log = (tmp_path / name for name in ("a.json", "b.json", "log.csv"))
    check_places([first, second], [log], force=False)
    for files in ([first, first], [log], [first, tmp_path / "." / "a.json"]):
        with pytest.raises(UsageError, match="a different name"):
            check_places(files, [log], force=True)


def test_an_existing_file_needs_force_and_a_folder_is_no_place(tmp_path):
    (tmp_path / "a.json").write_text("mine")
    with pytest.raises(UsageError, match="--force"):
        check_places([tmp_path / "a.json"], [], force=False)
    check_places([tmp_path / "a.json"], [], force=True)
    for place in (tmp_path, tmp_path / "no" / "a.json"):
        with pytest.raises(ImuwbError, match="cannot be written"):
            check_places([place], [], force=True)


def test_an_output_does_not_overwrite_the_sidecar_of_a_log(tmp_path):
    log, sidecar = tmp_path / "a.csv", tmp_path / "a.toml"
    log.write_text("1,2\n", "utf-8")
    sidecar.write_text("rate = 50\n", "utf-8")
    with pytest.raises(UsageError, match="sidecar"):
        check_places([sidecar], [log], force=True)
    sidecar.write_text('schema = 1\nname = "x"\n[gyro_x]\nprocesses = []\n', "utf-8")
    check_places([sidecar], [log], force=True)

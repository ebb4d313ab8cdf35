"""The lists of pyproject, the folders and the installed entry points are the same."""

import tomllib
from importlib.metadata import entry_points
from pathlib import Path

from imuwb.analysis import Analysis
from imuwb.simulation import preset_names

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))


def test_plugin_folders_are_entry_points():
    folders = {f"imuwb_plugins.{p.parent.name}" for p in (ROOT / "plugins" / "imuwb_plugins").glob("*/__init__.py")}
    points = PROJECT["project"]["entry-points"]
    plugins = [module for group in ("imuwb.analyses", "imuwb.conditioners") for module in points[group].values()]
    assert sorted(folders) == sorted(plugins)
    for group in ("imuwb.analyses", "imuwb.conditioners"):
        assert set(points[group].values()) <= {point.value for point in entry_points(group=group)}


def test_every_package_is_in_the_wheel_by_name():
    listed = PROJECT["tool"]["hatch"]["build"]["targets"]["wheel"]["packages"]
    assert {Path(p).name for p in listed} == set(PROJECT["tool"]["importlinter"]["root_packages"])
    assert all((ROOT / p / "__init__.py").is_file() for p in listed)


def test_every_reader_is_an_entry_point_and_keeps_the_contract():
    modules = set(PROJECT["project"]["entry-points"]["imuwb.readers"].values())
    for module in modules:
        reader = __import__(module, fromlist=["format"])
        assert isinstance(reader.format, str)
        assert callable(reader.probe)
        assert callable(reader.stream)
        assert not reader.probe(b"\x00\x01\x02")


def test_every_analysis_keeps_the_contract():
    names = [name for name in Analysis.__dict__ if not name.startswith("_")]
    for point in entry_points(group="imuwb.analyses"):
        analysis = point.load()
        for part in getattr(analysis, "METHODS", {point.name: analysis}).values():
            for name in (*names, "Parameters"):
                assert hasattr(part, name), (point.name, name)


def test_samples_are_small_and_named_with_their_command():
    files = [p for p in (ROOT / "samples").iterdir() if p.suffix not in (".md", ".ipynb")]
    assert sum(p.stat().st_size for p in files) <= 10e6
    table = (ROOT / "samples" / "README.md").read_text("utf-8")
    for file in files:
        assert f"`{file.name}`" in table
        assert f"-o samples/{file.name}" in table


def test_presets_ship_with_the_package():
    assert "3dm-gx3-25" in preset_names()


def test_every_conditioner_keeps_the_contract():
    for point in entry_points(group="imuwb.conditioners"):
        conditioner = point.load()
        assert hasattr(conditioner, "Parameters"), point.name
        assert callable(conditioner.condition), point.name

"""The lists of pyproject, the folders and the installed entry points are the same."""

import re
import shutil
import subprocess
import tomllib
from importlib.metadata import entry_points
from pathlib import Path

import pytest

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


#: name of a dependency -> its name on conda-forge, where the two differ
CONDA = {"isal": "python-isal", "matplotlib": "matplotlib-base"}
NOT_ON_CONDA = {"mcap-protobuf-support"}  #: imported for logs with protobuf only; the reader says what to install


def test_the_conda_recipe_has_the_dependencies_of_the_project():
    yaml = pytest.importorskip("yaml", reason="PyYAML reads the recipe, and is not installed")
    recipe = yaml.safe_load((ROOT / "conda" / "recipe.yaml").read_text("utf-8"))
    project = PROJECT["project"]
    wanted = {"python": project["requires-python"]}
    for text in project["dependencies"]:
        name = re.match(r"[\w-]+", text)[0]
        if name not in NOT_ON_CONDA:
            wanted[CONDA.get(name, name)] = text.removeprefix(name)
    run = recipe["requirements"]["run"]
    assert {(line.partition(" "))[0]: line.partition(" ")[2] for line in run} == wanted
    assert recipe["package"] == {"name": project["name"], "version": project["version"]}
    scripts = {f"{name} = {value}" for name, value in project["scripts"].items()}
    assert set(recipe["build"]["python"]["entry_points"]) == scripts


def test_the_image_warms_what_it_runs_and_runs_as_no_root():
    lines = (ROOT / "Dockerfile").read_text("utf-8").splitlines()
    user, warm = (next(i for i, line in enumerate(lines) if text in line) for text in ("USER imuwb", "imuwb warm"))
    assert warm < user < len(lines)
    assert any(line.startswith("ENV NUMBA_CACHE_DIR=") for line in lines)
    kept = (ROOT / ".dockerignore").read_text("utf-8").splitlines()
    needed = {"imuwb", "plugins", "samples", "pyproject.toml", "README.md", "LICENSE"}
    assert not needed & set(kept)


def test_the_manual_has_every_command_and_is_correct(monkeypatch, tmp_path):
    monkeypatch.syspath_prepend(ROOT / "docs")
    from making.manual import manual

    from imuwb.cli.app import COMMANDS

    text = manual()
    names = {name for group in ("imuwb.analyses",) for name in PROJECT["project"]["entry-points"][group]}
    for name in (*COMMANDS, *names):
        assert f".SS imuwb {name}".replace("-", r"\-") in text
    assert r"\-\-error\-model" in text
    groff = shutil.which("groff")
    if groff is None:
        pytest.skip("groff is not installed")
    page = tmp_path / "imuwb.1"
    page.write_text(text, "utf-8")
    done = subprocess.run([groff, "-Kutf8", "-man", "-ww", "-Tutf8", str(page)], capture_output=True, check=False)
    assert (done.returncode, done.stderr) == (0, b"")

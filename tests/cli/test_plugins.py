"""imuwb plugins: new plugins are whole, keep their contract, and pass what checks them; check says which rule is broken."""

import json
import shutil
import subprocess
import sys
import tomllib

import pytest

KINDS = ("analysis", "conditioner", "reader")


@pytest.fixture
def own_modules(monkeypatch, tmp_path):
    """Forget the modules of plugins that a test imports."""
    before = set(sys.modules)
    monkeypatch.setattr(sys, "path", [str(tmp_path), *sys.path])
    yield
    for name in set(sys.modules) - before:
        if "odd_" in name:
            del sys.modules[name]


@pytest.mark.parametrize("kind", KINDS)
def test_a_new_file_passes_its_own_tests(imuwb, tmp_path, own_modules, kind):
    done = imuwb("plugins", "new", kind, f"odd_{kind}")
    assert (done.code, f"odd_{kind}.py" in done.err) == (0, True)
    tests = str(tmp_path / f"test_odd_{kind}.py")
    assert pytest.main(["-q", "-p", "no:cacheprovider", "-p", "no:xdist", "--rootdir", str(tmp_path), tests]) == 0
    check = imuwb("plugins", "check", f"odd_{kind}.py")
    assert (check.code, "passed" in check.out, "FAILED" in check.out) == (0, True, False)
    ruff = shutil.which("ruff")
    if ruff is not None:
        assert subprocess.run([ruff, "check", "--isolated", "-q", "."], cwd=tmp_path, check=False).returncode == 0


@pytest.mark.parametrize("kind", KINDS)
def test_a_new_package_is_whole(imuwb, tmp_path, kind):
    done = imuwb("plugins", "new", kind, f"odd_{kind}", "--package")
    assert (done.code, "7 files" in done.err) == (0, True)
    root = tmp_path / f"odd_{kind}"
    project = tomllib.loads((root / "pyproject.toml").read_text("utf-8"))["project"]
    (group,) = project["entry-points"]
    assert group in ("imuwb.analyses", "imuwb.conditioners", "imuwb.readers")
    assert project["entry-points"][group] == {f"odd_{kind}": f"odd_{kind}"}
    assert all("plugin_" not in file.read_text("utf-8") for file in root.rglob("*.*") if file.is_file())
    ruff = shutil.which("ruff")
    if ruff is not None:
        for command in (("check",), ("format", "--check")):
            assert subprocess.run([ruff, *command, "-q", "."], cwd=root, check=False).returncode == 0


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("pyright") is None, reason="pyright is not installed")
def test_new_plugins_have_types(imuwb, tmp_path):
    for kind in KINDS:
        imuwb("plugins", "new", kind, f"odd_{kind}")
    (tmp_path / "pyrightconfig.json").write_text('{"typeCheckingMode": "strict"}', "utf-8")
    done = subprocess.run([shutil.which("pyright")], cwd=tmp_path, check=False, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout


def test_a_new_plugin_overwrites_nothing(imuwb, tmp_path):
    (tmp_path / "test_odd.py").write_text("mine", "utf-8")
    done = imuwb("plugins", "new", "analysis", "odd")
    assert (done.code, "test_odd.py exists" in done.err) == (2, True)
    assert not (tmp_path / "odd.py").exists()
    assert (tmp_path / "test_odd.py").read_text("utf-8") == "mine"
    assert imuwb("plugins", "new", "analysis", "odd", "--force").code == 0


def test_a_new_plugin_is_whole_or_nowhere(imuwb, tmp_path):
    (tmp_path / "test_odd.py").mkdir()
    done = imuwb("plugins", "new", "analysis", "odd", "--force")
    assert (done.code, "test_odd.py" in done.err) == (1, True)
    assert not (tmp_path / "odd.py").exists()
    (tmp_path / "odd_two").write_text("mine", "utf-8")
    done = imuwb("plugins", "new", "analysis", "odd_two", "--package")
    assert (done.code, "--folder" in done.err) == (1, True)
    assert (tmp_path / "odd_two").read_text("utf-8") == "mine"


@pytest.mark.parametrize("name", ["Odd", "my-plugin", "x", "class", "allan", "json", "plan", "../odd"])
def test_a_name_that_cannot_be_used_is_refused(imuwb, tmp_path, name):
    done = imuwb("plugins", "new", "analysis", name)
    assert (done.code, name in done.err) == (2, True)
    assert list(tmp_path.iterdir()) == []


def test_a_conditioner_in_a_file_is_used_at_once(imuwb, static_mcap):
    imuwb("plugins", "new", "conditioner", "odd_mean")
    done = imuwb("psd", static_mcap, "--through", "./odd_mean.py:samples=3,causal=true", "--json", "psd.json")
    assert done.code == 0, done.err
    (log,) = json.loads((static_mcap.parent / "psd.json").read_text("utf-8"))["logs"]
    assert log["conditioning"][0]["name"] == "odd_mean"
    even = imuwb("psd", static_mcap, "--through", "./odd_mean.py:samples=4")
    assert (even.code, "odd number" in even.err) == (2, True)
    (static_mcap.parent / "none.py").write_text("x = 1\n", "utf-8")
    none = imuwb("psd", static_mcap, "--through", "./none.py")
    assert (none.code, "Parameters" in none.err) == (2, True)


BROKEN = '''"""Counts."""
from dataclasses import dataclass
from imuwb.analysis import Table

@dataclass(frozen=True)
class Parameters:
    rate: float = 1.0

def run(logs, parameters):
    return {"axes": len(logs[0].imu().axes())}

def draw(result, review):
    review.table(Table("Axes", ("axes",), ((str(result["axes"]),),)))
'''


def test_a_broken_plugin_is_told_what_to_do(imuwb, tmp_path):
    (tmp_path / "odd.py").write_text(BROKEN, "utf-8")
    done = imuwb("plugins", "check", "odd.py")
    assert done.code == 1
    assert "rate has no help" in done.out
    assert "imuwb.options.Options" in done.out
    assert "rename the plugin's parameters" in done.out  # every analysis has --rate
    document = json.loads(imuwb("plugins", "check", "odd.py", "--json").out)
    (report,) = document["plugins"]
    assert {one["rule"] for one in report["outcomes"] if one["state"] == "failed"} == {"help", "parameters", "command"}


def test_a_check_of_nothing_is_refused(imuwb, tmp_path):
    assert imuwb("plugins", "check", "nothing").code == 2
    assert imuwb("plugins", "check", "nothing.py").code == 2
    assert imuwb("plugins", "check", "psd", "--with", "level").code == 2
    assert imuwb("plugins", "check", "psd", "missing.mcap").code == 4
    (tmp_path / "none.py").write_text("x = 1\n", "utf-8")
    none = imuwb("plugins", "check", "none.py")
    assert (none.code, "no plugin" in none.err, "imuwb_file" in none.err) == (2, True, False)
    (tmp_path / "folder.py").mkdir()
    (tmp_path / "package").mkdir()
    assert "folder" in imuwb("plugins", "check", "folder.py").err
    assert "pip install -e package" in imuwb("plugins", "check", "package").err


def test_what_a_plugin_prints_is_no_part_of_the_report(imuwb, tmp_path):
    (tmp_path / "odd.py").write_text(BROKEN + '\nprint("hello")\n', "utf-8")
    done = imuwb("plugins", "check", "odd.py", "--json")
    assert (json.loads(done.out)["schema"], "hello" in done.err) == (1, True)


def test_a_plugin_that_leaves_is_no_success(imuwb, tmp_path, static_mcap):
    (tmp_path / "odd.py").write_text(
        BROKEN.replace('    return {"axes"', '    raise SystemExit(0)\n    return {"axes"'), "utf-8"
    )
    done = imuwb("plugins", "check", "odd.py")
    assert (done.code, "SystemExit" in done.out, "odd.py" in done.out) == (1, True, True)
    (tmp_path / "odd.py").write_text(
        BROKEN.replace("rate", "pace").replace('return {"axes"', 'raise SystemExit(0)  # {"'), "utf-8"
    )
    run = imuwb(str(tmp_path / "odd.py"), static_mcap)
    assert (run.code, "SystemExit" in run.err) == (1, True)


@pytest.mark.parametrize("fault", ["raise SystemExit(0)", "1 / 0", "return log"])
def test_a_fault_of_a_conditioner_is_its_own(imuwb, tmp_path, static_mcap, fault):
    text = (
        '"""Odd."""\nfrom dataclasses import dataclass\n@dataclass(frozen=True)\nclass Parameters:\n    """None."""\n'
    )
    (tmp_path / "odd.py").write_text(text + f"def condition(log, parameters):\n    {fault}\n", "utf-8")
    done = imuwb("psd", static_mcap, "--through", "./odd.py")
    assert (done.code, "conditioner odd failed" in done.err) == (1, True), done.err


def test_an_installed_plugin_is_checked_by_its_name(imuwb):
    done = imuwb("plugins", "check", "decimate", "--with", "factor=2")
    assert (done.code, "causality" in done.out) == (0, True)

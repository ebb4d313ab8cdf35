"""What import-linter cannot see: circles between files, plugins named in strings, files and functions that grow too long."""

import ast
import re
from functools import cache
from importlib.metadata import entry_points
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = (ROOT / "imuwb", ROOT / "plugins" / "imuwb_plugins")
LONGEST_FILE, LONGEST_FUNCTION = 400, 60  #: lines
#: Names of plugins that are also terms of the field -> the floors where they stand as such.
TERMS = {
    "allan": {"identification"},  # a kind of deviation
    "autoregressive": {"identification", "stochastic"},  # a process
    "bandwidth": {"stochastic", "review"},  # a term of an error model
    "bias": {"conditioning", "estimators", "identification", "review", "stochastic"},  # likewise
    "calibration": {"estimators", "stochastic"},  # the deterministic terms of a model
    "kaiser": {"conditioning"},  # a window
    "noise": {"identification", "replay"},  # what is estimated
    "temperature": {
        "fleet",
        "identification",
        "readers",
        "review",
        "units.py",
        "log.py",
        "summary.py",
        "selection.py",
        "testing",
        "writers",
    },  # a quantity
    "wavelet": {"identification"},  # a kind of variance
}


@cache
def modules() -> dict[str, Path]:
    """Return {dotted name: file} of all modules."""
    files = [file for package in PACKAGES for file in package.rglob("*.py")]
    found = {
        ".".join(f.relative_to(next(p.parent for p in PACKAGES if p in f.parents)).with_suffix("").parts): f
        for f in files
    }
    return {name.removesuffix(".__init__"): file for name, file in found.items()}


def imports(file: Path) -> set[str]:
    """Return the modules that a file imports, also those that only a type checker sees."""
    named: set[str] = set()
    for node in ast.walk(ast.parse(file.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            named |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                whole = f"{node.module}.{alias.name}"
                named.add(whole if whole in modules() else node.module)
    return named & modules().keys()


def circle(graph: dict[str, set[str]]) -> list[str]:
    """Return the names along one circle of a graph; empty where there is none."""
    state: dict[str, int] = {}
    path: list[str] = []

    def visit(name: str) -> list[str]:
        state[name] = 1
        path.append(name)
        for other in sorted(graph[name] - {name}):
            if state.get(other) == 1:
                return path[path.index(other) :]
            if other not in state and (ring := visit(other)):
                return ring
        state[name] = 2
        path.pop()
        return []

    return next((ring for name in sorted(graph) if name not in state and (ring := visit(name))), [])


def test_a_circle_is_seen():
    assert circle({"a": {"b"}, "b": {"c"}, "c": {"b"}}) == ["b", "c"]
    assert circle({"a": {"b", "c"}, "b": {"c"}, "c": set()}) == []


@pytest.mark.slow
def test_no_circle_between_files():
    assert circle({name: imports(file) for name, file in modules().items()}) == []


def texts(file: Path) -> list[tuple[int, str]]:
    """Return (line, text) of the strings of a file that are no docstrings."""
    tree = ast.parse(file.read_text("utf-8"))
    documented = (ast.Module, ast.ClassDef, ast.FunctionDef)
    docs = {
        id(node.body[0].value)
        for node in ast.walk(tree)
        if isinstance(node, documented) and isinstance(node.body[0], ast.Expr)
    }
    return [
        (node.lineno, node.value)
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in docs
    ]


@pytest.mark.slow
def test_no_string_of_the_core_names_a_plugin():
    points = (*entry_points(group="imuwb.analyses"), *entry_points(group="imuwb.conditioners"))
    names = {point.name for point in points if point.value.startswith("imuwb_plugins")}
    assert names
    command = re.compile(rf"imuwb_plugins|\bimuwb ({'|'.join(names)})\b")
    named = [
        f"{file.relative_to(ROOT)}:{line}: {text!r}"
        for file in (ROOT / "imuwb").rglob("*.py")
        for line, text in texts(file)
        if command.search(text) or (text in names and file.relative_to(ROOT).parts[1] not in TERMS.get(text, ()))
    ]
    assert named == []


@pytest.mark.slow
@pytest.mark.parametrize("folder", ["imuwb", "plugins", "tests"])
def test_files_and_functions_stay_short(folder):
    long = []
    for file in (ROOT / folder).rglob("*.py"):
        text = file.read_text("utf-8")
        lines = text.count("\n")
        if lines > LONGEST_FILE:
            long.append(f"{file.relative_to(ROOT)}: {lines} lines")
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.FunctionDef) and not any("compiled" in ast.unparse(d) for d in node.decorator_list):
                size = node.end_lineno - node.lineno + 1
                if size > LONGEST_FUNCTION:
                    long.append(f"{file.relative_to(ROOT)}: {node.name} has {size} lines")
    assert long == []

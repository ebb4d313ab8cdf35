"""Every verdict and every kind of fault that imuwb prints is explained, and terms are found by the names that people use."""

import ast
import re
from pathlib import Path

import pytest

from imuwb.explanations import anchor_of, explanation_of, explanations, near
from imuwb.health.check import TOO_SHORT, VERDICTS
from imuwb.health.fault import _HARMLESS, LOST

ROOT = Path(__file__).parents[1]


def calls(folder, name):
    """Yield the calls of a name in the files of a folder, or of one file."""
    place = ROOT / folder
    for file in [place] if place.is_file() else sorted(place.rglob("*.py")):
        for node in ast.walk(ast.parse(file.read_text("utf-8"))):
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") == name:
                yield file, node


def assigned(file, name):
    """Return the texts that a file assigns to a name, alone, as the first of several, or one of two by a condition."""
    found = set()
    for node in ast.walk(ast.parse(file.read_text("utf-8"))):
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]).strip("(").split(",")[0] == name:
            branches = [node.value.body, node.value.orelse] if isinstance(node.value, ast.IfExp) else [node.value]
            firsts = [one.elts[0] if isinstance(one, ast.Tuple) else one for one in branches]
            found |= {one.value for one in firsts if isinstance(one, ast.Constant)}
    return found


def kinds_of_faults():
    """Return the kinds that are written in the checks; one that is a name is taken from the assignment to that name."""
    found = {LOST, "repair", "short", *(name.replace("_", " ") for name in _HARMLESS)}
    for file, call in calls("imuwb/health", "Fault"):
        kind = call.args[1]
        if isinstance(kind, ast.Constant):
            found.add(kind.value)
        elif isinstance(kind, ast.JoinedStr):
            found |= {f"no {what} sigma" for what in ("position", "velocity")}
        else:
            found |= assigned(file, "kind")
    return found


def verdicts():
    words = {
        call.args[0].value
        for _, call in calls("plugins/imuwb_plugins/allan/trust.py", "Trust")
        if isinstance(call.args[0], ast.Constant)
    }
    ids = {
        call.args[0].value
        for file in ("imuwb/health/still_record.py", "imuwb/replay/scoring/statistics.py", "imuwb/estimators/calibration/logged.py")
        for _, call in calls(file, "Note")
        if isinstance(call.args[0], ast.Constant)
    }  # fmt: skip
    outcomes = re.findall(r'outcome = "([\w ]+)"', (ROOT / "imuwb/stochastic/model_check.py").read_text("utf-8"))
    return words | ids | set(outcomes) | {"yes", TOO_SHORT, *VERDICTS}


def test_enough_is_enumerated():
    assert {
        "gaps",
        "batches",
        "stuck thermometer",
        "no velocity sigma",
        "clock offset",
        "lost rows",
    } <= kinds_of_faults()
    assert {"shaken", "moved", "sigma-small", "not sure", "heavy-tails", "corrected-before"} <= verdicts()


@pytest.mark.parametrize("name", sorted(kinds_of_faults() | verdicts()))
def test_a_verdict_or_a_fault_is_explained_under_its_own_name(name):
    found = explanation_of(name)
    assert found is not None, name
    assert len(found.text.split()) >= 6, name


@pytest.mark.parametrize(
    ("said", "name"),
    [
        ("ARW", "N"), ("angle random walk", "N"), ("VRW", "N"), ("bias instability", "B"), ("Bias_Instability", "B"), ("k", "K"),
        ("NEES", "NEES"), ("nis", "NIS"), ("coverage", "coverage"), ("Allan deviation", "Allan deviation"), ("effective n", "effective n"),
        ("horizon", "horizon"), ("outage", "outage"), ("sigma small", "sigma-small"), ("too small", "sigma-small"),
    ],
)  # fmt: skip
def test_terms_are_found_by_the_names_that_people_use(said, name):
    assert explanation_of(said).name == name


def test_anchors_are_different_and_unknown_terms_get_near_ones():
    anchors = [one.anchor for one in explanations().values()]
    assert len(anchors) == len(set(anchors))
    assert anchor_of("1/f no 3D fix") == "1f-no-3d-fix"
    assert explanation_of("clok jump") is None
    assert "clock jump" in near("clok jump")
    assert near("zzzzzz") == ()

import json
from dataclasses import dataclass, field

import numpy as np

from imuwb.analysis import Answer, Step
from imuwb.review.answers.document import answer_document, document, plain
from imuwb.review.answers.panel import Origin
from imuwb.stochastic import WhiteNoise


def test_json_has_no_nan_and_keeps_names():
    content = plain({"a": np.array([1.0, np.nan]), "b": np.float64("inf"), "c": (1, None), "d": np.int64(3)})
    assert json.dumps(content, allow_nan=False) == '{"a": [1.0, null], "b": null, "c": [1, null], "d": 3}'


def test_fields_for_figures_alone_are_left_out_and_processes_are_named():
    @dataclass
    class Result:
        value: float = 1.0
        drawn: float = field(default=2.0, metadata={"document": False})

    assert plain(Result()) == {"value": 1.0}
    assert plain(WhiteNoise(2.0)) == {"process": "white_noise", "N": 2.0}


def test_the_answer_is_in_the_document_and_does_not_change_its_name():
    answer = Answer("1 h", ("", "N"), (("gyro x", "2.4"),), ("Trust it.",), (Step("imuwb psd {log}", "why"),))
    names = []
    for path in ("a.csv", "b/a.csv"):
        shown = answer_document(answer, Origin("noise", (path,)))
        text, run = document("noise", "0.1", {"level": 0.95}, {"n": 1}, (), (), answer=shown)
        found = json.loads(text)
        assert found["run"] == run
        assert found["answer"]["rows"] == [["gyro x", "2.4"]]
        assert found["answer"]["sentences"] == ["Trust it."]
        assert found["answer"]["next"] == [{"command": f"imuwb psd {path}", "why": "why"}]
        names.append(run)
    assert names[0] == names[1] == document("noise", "0.1", {"level": 0.95}, {"n": 1}, (), ())[1]

import json
from dataclasses import dataclass, field

import numpy as np

from imuwb.review.answers.document import plain
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

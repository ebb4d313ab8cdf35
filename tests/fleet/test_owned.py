"""Sensors and vehicles of logs are counted in one way."""

import pytest

from imuwb.fleet.owned import owned


@pytest.mark.parametrize(
    ("owners", "text", "sentences"),
    [
        ([("v1", "A"), ("v2", "A"), ("v1", "B")], "2 sensors", ["Serial A is in 2 vehicles (v1, v2)"]),
        ([("v1", None), ("v2", None), ("v2", None)], "2 vehicles, whose sensors are not named", []),
        (
            [("v1", "A"), ("v2", None), (None, None)],
            "1 sensor and 1 vehicle, whose",
            ["The sensor of 1 log is not known"],
        ),
        ([(None, None)] * 2, "unknown sensors", ["The sensor of 2 logs is not known"]),
        ([(None, "A"), ("v1", "A")], "1 sensor", []),
    ],
)
def test_whose_the_logs_are(owners, text, sentences):
    found = owned(owners)
    assert found.text.startswith(text)
    assert len(found.sentences()) == len(sentences)
    assert all(said in one for said, one in zip(sentences, found.sentences(), strict=True))

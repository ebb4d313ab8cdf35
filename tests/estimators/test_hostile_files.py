"""Files of estimators, and models, that are made to do harm: their words end no comment, and no text takes more than linear time."""

import time
from dataclasses import replace

import pytest

from imuwb.errors import ImuwbError
from imuwb.estimators import Options, export, read_estimator_text
from imuwb.simulation import preset
from imuwb.stochastic import ImuErrorModel

WORDS = "a\nIMU.gyr_n: 7\x1b[2J --> <evil/> ---> \u202eb"


@pytest.mark.parametrize("tool", ["gazebo", "kalibr", "matlab", "gtsam", "airsim"])
def test_words_of_a_model_stay_in_one_comment(tool):
    model = replace(preset("mpu-6050"), name=WORDS, provenance={"log": WORDS})
    text = export(model, tool, Options(rate=200.0)).text
    assert not {"\x1b", "\u202e"} & set(text)
    assert "\nIMU.gyr_n" not in text
    if tool == "gazebo":
        assert text.count("-->") == text.count("<!--")
        assert text.index("-->") > text.index("evil")


def test_words_of_a_document_are_cleaned_where_it_is_read():
    read = ImuErrorModel.from_toml(replace(preset("mpu-6050"), name=WORDS, provenance={"log": WORDS}).to_toml())
    assert "\n" not in read.name + read.provenance["log"]
    assert read.name.isprintable()


@pytest.mark.parametrize(
    ("text", "tool"),
    [("gyroscope_noise_density:" + " " * 300_000 + "x", "kalibr"), ("gyroparams('NoiseDensity'," + "1" * 300_000, "matlab"),
     ("<!--" * 75_000, "gazebo"), ("gyroparams(" + "a=" * 150_000, None)],
)  # fmt: skip
def test_a_text_takes_time_in_proportion(text, tool):
    began = time.process_time()
    with pytest.raises(ImuwbError):
        read_estimator_text(text, "x", tool)
    assert time.process_time() - began < 2

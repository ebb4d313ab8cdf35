"""Results of other programs that analyse still records: imu_utils, its variants, and allan_variance_ros."""

import math
import re

from imuwb.errors import UsageError
from imuwb.estimators.formula import Setting
from imuwb.stochastic import FLICKER_LEVEL, AxisModel, FlickerNoise, ImuErrorModel, RandomWalk, Sum, WhiteNoise

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
SLOPES = "allan_variance_ros fits the random walk over all averaging times: K is an upper limit, often 1.1 to 2 times the true one"


def is_imu_utils(text: str) -> bool:
    """Return whether a text is a result of imu_utils."""
    return all(word in text for word in ("avg-axis", "gyr_n", "acc_n"))


def is_allan_variance_ros(text: str) -> bool:
    """Return whether a text is a result of allan_variance_ros, which writes Kalibr's names with a remark of its own."""
    return "gyroscope_noise_density" in text and "Make sure this is correct" in text


def read_imu_utils(text: str, where: str, setting: Setting) -> tuple[ImuErrorModel, tuple[str, ...]]:
    """Return the model of a result of imu_utils, and notes.

    imu_utils (src/fitallan_gyr.cpp) writes gyr_n = √f times the Allan deviation at 1 s, and gyr_w, the lowest point of the
    Allan curve. A variant states the units of densities, and its values are N and K.

    Raises:
        UsageError: no rate, which the file does not state.
    """
    densities = re.search(r"unit:\s*\"[^\"]*sqrt", text) is not None
    if not densities and math.isnan(setting.rate):
        raise UsageError(
            f"{where}: imu_utils multiplies N by the root of the record's rate, which the file does not state; give --rate HZ"
        )
    axes: dict[str, AxisModel] = {}
    for sensor, short in (("gyro", "gyr"), ("accel", "acc")):
        for letter in "xyz":
            block = re.search(rf"{letter}-axis:\s*\n((?:\s+{short}_\w+:.*\n?)+)", text)
            if block is None:
                continue
            found = dict(re.findall(rf"{short}_([nw]):\s*({_NUMBER})", block[1]))
            terms = []
            if "n" in found:
                terms.append(WhiteNoise(float(found["n"]) / (1.0 if densities else math.sqrt(setting.rate))))
            if "w" in found:
                slow = float(found["w"])
                terms.append(RandomWalk(slow) if densities else FlickerNoise(slow / FLICKER_LEVEL))
            axes[f"{sensor}_{letter}"] = AxisModel(Sum(tuple(terms)))
    if not axes:
        raise UsageError(f"{where}: no axis of gyr_n or acc_n was found in a result of imu_utils")
    meaning = (
        "its values are densities: n is N, w is K"
        if densities
        else "n is N times the root of the rate; w is the lowest point of the Allan curve, not a random walk: it becomes B, at most"
    )
    provenance = {"source": f"{where}, a result of imu_utils"}
    if not densities:
        provenance["rate"] = f"{setting.rate:g} Hz"
    return ImuErrorModel(
        "imu_utils", axes, provenance, ("read from another program's result: no interval is known",)
    ), (meaning,)

"""A user's file, for a type checker: what imuwb gives has types, also where it is imported when it is first used.

``.ci/run wheel`` checks it against the installed wheel; it is never run.
"""

from typing import assert_type

import numpy as np
from numpy.typing import NDArray

import imuwb
from imuwb.stochastic import FlickerNoise, WhiteNoise

log = imuwb.read("static.mcap")
assert_type(log, imuwb.Log)
assert_type(log.imu(), imuwb.log.ImuStream)

time, rate = log.imu().axes()["gyro_z"]
assert_type(rate, NDArray[np.float64])

curve = imuwb.identification.allan(rate, dt=0.05)
assert_type(curve, imuwb.identification.AllanDeviation)
fit = imuwb.identification.fit_allan(curve)
assert_type(fit.coefficients["N"], imuwb.statistics.Coefficient)

noise = WhiteNoise(N=7e-4) + FlickerNoise(B=2e-4)
assert_type(noise.allan_variance(np.array([1.0]), dt=0.01), NDArray[np.float64])

model = imuwb.ImuErrorModel.read("model.toml")
assert_type(model, imuwb.ImuErrorModel)

"""The noise of an exported file, propagated as its consumer's own code does it, grows as that of the model.

Each consumer's step is written here from its source, named beside it. The yardstick is the growth of attitude, velocity and
position over 60 s of the model's white noise and random walk, the start being known.
"""

import math

import numpy as np
import pytest

from imuwb.estimators import Options, export, tools
from imuwb.estimators.growth import walk_variance, white_variance
from imuwb.stochastic import RandomWalk, WhiteNoise

RATE, T, STEP = 200.0, 60.0, 0.01
GYRO, ACCEL = (1.6e-4, 1.2e-6), (2.1e-3, 3e-4)
DEGREE = math.pi / 180
HOUR = 3600.0


def grown(white, drive, decay, dt):
    """Return the sd after T of the first, second and third integral of white noise and of a bias, for one axis.

    Args:
        white: variance that the rate's integral gains in a step.
        drive: variance that the bias gains in a step.
        decay: factor of the bias in a step.
        dt: s.
    """
    step = np.eye(4)
    step[0, 1] = step[1, 2] = step[2, 3] = dt
    step[0, 2], step[0, 3], step[1, 3] = dt**2 / 2, dt**3 / 6, dt**2 / 2
    step[3, 3] = decay
    once = np.diag([0.0, 0.0, white, drive])
    total, turned = np.zeros((4, 4)), np.eye(4)
    for digit in f"{round(T / dt):b}":  # 2n steps are n and n more
        total, turned = total + turned @ total @ turned.T, turned @ turned
        if digit == "1":
            total, turned = step @ total @ step.T + once, step @ turned
    return np.sqrt(np.diag(total)[2::-1])


def per_sample(n_density, k_density, dt=1 / RATE):
    """Return (white, drive, decay, dt) of continuous densities."""
    return n_density**2 * dt, k_density**2 * dt, 1.0, dt


def gauss_markov(n_density, sigma, tau, dt=1 / RATE):
    """Return the same for a bias with q = 2σ²/τ and 1 - dt/τ (KF-GINS, OB_GINS, NaveGo)."""
    return n_density**2 * dt, 2 * sigma**2 / tau * dt, 1 - dt / tau, dt


#: tool -> for gyro and accel, the step of the consumer, from the values of the file
CONSUMERS = {
    # kalibr_common/ConfigReader.py: N/√dt a sample; IccSensors.py: 1/K² on the integral of the squared derivative
    "kalibr": lambda v: (
        per_sample(v["gyroscope_noise_density"], v["gyroscope_random_walk"]),
        per_sample(v["accelerometer_noise_density"], v["accelerometer_random_walk"]),
    ),
    # ov_msckf/src/state/Propagator.cpp: Qd = G diag(N²/dt, K² dt) Gᵀ, G has dt
    "openvins": lambda v: (
        per_sample(v["gyroscope_noise_density"], v["gyroscope_random_walk"]),
        per_sample(v["accelerometer_noise_density"], v["accelerometer_random_walk"]),
    ),
    # factor/integration_base.h: two independent ends, each with half the step; the bias gains (dt w)²
    "vins": lambda v: tuple(
        (2 * (0.5 / RATE * v[f"{s}_n"]) ** 2, (v[f"{s}_w"] / RATE) ** 2, 1.0, 1 / RATE) for s in ("gyr", "acc")
    ),
    # src/ImuTypes.cc: covariance of a sample (N √f)², times dt²; the walk (K/√f)² a sample
    "orb-slam3": lambda v: tuple(
        (v[n] ** 2 * v["IMU.Frequency"] / RATE**2, v[k] ** 2 / v["IMU.Frequency"], 1.0, 1 / RATE)
        for n, k in (("IMU.NoiseGyro", "IMU.GyroWalk"), ("IMU.NoiseAcc", "IMU.AccWalk"))
    ),
    # src/imuPreintegration.cpp: N² as GTSAM's covariance; between biases √Δt K
    "lio-sam": lambda v: (per_sample(v["imuGyrNoise"], v["imuGyrBiasN"]), per_sample(v["imuAccNoise"], v["imuAccBiasN"])),
    # esekfom.hpp: P = F P Fᵀ + (dt G) Q (dt G)ᵀ
    "fast-lio": lambda v: tuple(
        (v[f"{s}_cov"] / RATE**2, v[f"b_{s}_cov"] / RATE**2, 1.0, 1 / RATE) for s in ("gyr", "acc")
    ),
    # navigation/ImuFactor.cpp: covariance/dt · dt²; CombinedImuFactor.cpp: bias covariance · dt
    "gtsam": lambda v: tuple(
        (v[n] / RATE, v[k] / RATE, 1.0, 1 / RATE)
        for n, k in (("setGyroscopeCovariance", "setBiasOmegaCovariance"), ("setAccelerometerCovariance", "setBiasAccCovariance"))
    ),
    # ImuFrontend.cpp: N², K² as GTSAM's
    "kimera": lambda v: (
        per_sample(v["gyroscope_noise_density"], v["gyroscope_random_walk"]),
        per_sample(v["accelerometer_noise_density"], v["accelerometer_random_walk"]),
    ),
    # src/kf-gins/gi_engine.cpp
    "kf-gins": lambda v: (
        gauss_markov(v["arw"] * DEGREE / 60, v["gbstd"] * DEGREE / HOUR, v["corrtime"] * HOUR),
        gauss_markov(v["vrw"] / 60, v["abstd"] * 1e-5, v["corrtime"] * HOUR),
    ),
    # src/preintegration/preintegration_normal.cc
    "ob-gins": lambda v: (
        gauss_markov(v["arw"] * DEGREE / 60, v["gbstd"] * DEGREE / HOUR, v["corrtime"] * HOUR),
        gauss_markov(v["vrw"] / 60, v["abstd"] * 1e-5, v["corrtime"] * HOUR),
    ),
    # ins-gnss/kf_prediction.m: Q = [arw vrw gb_psd ab_psd]² dt
    "navego": lambda v: tuple(
        (v[f"imu.{n}"] ** 2 / RATE, v[f"imu.{b}_psd"] ** 2 / RATE, 1 - 1 / RATE / v[f"imu.{b}_corr"], 1 / RATE)
        for n, b in (("arw", "gb"), ("vrw", "ab"))
    ),
    # base/imuerrset.m, 19-state filters, g0 = 9.7803267714
    "psins": lambda v: (
        per_sample(v["web"] * DEGREE / 60, v["sqrtR0G"] * DEGREE / HOUR / 60),
        per_sample(v["wdb"] * 9.7803267714e-6, v["sqrtR0A"] * 9.7803267714e-6 / 60),
    ),
    # pyins/kalman.py: Van Loan of continuous densities
    "pyins": lambda v: (per_sample(v["gyro_noise"], v["gyro_bias_walk"]), per_sample(v["accel_noise"], v["accel_bias_walk"])),
    # no public code: root densities of rates, in degrees
    "inertial-explorer": lambda v: (
        per_sample(v["misalignment_spectral_density"] * DEGREE, v["gyro_drift_spectral_density"] * DEGREE),
        per_sample(v["velocity_spectral_density"], v["accel_bias_spectral_density"]),
    ),
    # EKF/covariance.cpp: (dt p)² for the angle or velocity and for the bias, a step
    "px4": lambda v: tuple(
        ((STEP * v[f"EKF2_{s}_NOISE"]) ** 2, (STEP * v[f"EKF2_{s}_B_NOISE"]) ** 2, 1.0, STEP) for s in ("GYR", "ACC")
    ),
    # AP_NavEKF3_core.cpp: the same, at its own step
    "ardupilot": lambda v: tuple(
        ((0.0125 * v[f"EK3_{s}_P_NSE"]) ** 2, (0.0125 * v[f"EK3_{b}_P_NSE"]) ** 2, 1.0, 0.0125)
        for s, b in (("GYRO", "GBIAS"), ("ACC", "ABIAS"))
    ),
    # generated code of imuSensor: single-sided: white sd N √f, step of the walk K/√f
    "matlab": lambda v: tuple(
        (v[f"{s}.NoiseDensity"] ** 2 / RATE, v[f"{s}.RandomWalk"] ** 2 / RATE, 1.0, 1 / RATE) for s in ("gyro", "accel")
    ),
    # pathgen.py: a = 1 - dt/τ, b = σ √(1 - e^(-2 dt/τ)); white sd of a sample N √f
    "gnss-ins-sim": lambda v: tuple(
        (n**2 / RATE, sigma**2 * -math.expm1(-2 / RATE / tau), 1 - 1 / RATE / tau, 1 / RATE)
        for n, sigma, tau in (
            (v["gyro_arw"] * DEGREE / 60, v["gyro_b_stability"] * DEGREE / HOUR, v["gyro_b_corr"]),
            (v["accel_vrw"] / 60, v["accel_b_stability"], v["accel_b_corr"]),
        )
    ),
    # gz-sensors, GaussianNoiseModel.cc: σ_d = √(s² τ/2 (1 - e^(-2 dt/τ))), decay e^(-dt/τ)
    "gazebo": lambda v: tuple(
        (
            (v[f"{p}/x/noise/stddev"] / RATE) ** 2,
            v[f"{p}/x/noise/dynamic_bias_stddev"] ** 2 * tau / 2 * -math.expm1(-2 / RATE / tau),
            math.exp(-1 / RATE / tau),
            1 / RATE,
        )
        for p in ("angular_velocity", "linear_acceleration")
        for tau in (v[f"{p}/x/noise/dynamic_bias_correlation_time"],)
    ),
    # ImuSimple.hpp: bias walk of stability/√τ
    "airsim": lambda v: (
        per_sample(v["AngularRandomWalk"] * DEGREE / 60, v["GyroBiasStability"] * DEGREE / HOUR / math.sqrt(v["GyroBiasStabilityTau"])),
        per_sample(v["VelocityRandomWalk"] * 9.80665e-3, v["AccelBiasStability"] * 9.80665e-6 / math.sqrt(v["AccelBiasStabilityTau"])),
    ),
    # gazebo_imu_plugin: density that drives a bias of a correlation time; Pegasus has the same form
    "rotors": lambda v: tuple(
        gauss_markov(v[f"{s}NoiseDensity"], v[f"{s}RandomWalk"] * math.sqrt(v[f"{s}BiasCorrelationTime"] / 2), v[f"{s}BiasCorrelationTime"])
        for s in ("gyroscope", "accelerometer")
    ),
    "pegasus": lambda v: tuple(
        gauss_markov(v[f"{s}_noise_density"], v[f"{s}_random_walk"] * math.sqrt(v[f"{s}_bias_correlation_time"] / 2), v[f"{s}_bias_correlation_time"])
        for s in ("gyroscope", "accelerometer")
    ),
}  # fmt: skip


@pytest.fixture(scope="module")
def sensor(made):
    return made(
        (lambda s: WhiteNoise(GYRO[0] * s), lambda s: RandomWalk(GYRO[1] * s)),
        (lambda s: WhiteNoise(ACCEL[0] * s), lambda s: RandomWalk(ACCEL[1] * s)),
        growth=0,
    )


def test_every_tool_but_a_messages_covariance_is_proven_here():
    assert set(CONSUMERS) == set(tools()) - {"ros"}


@pytest.mark.parametrize("tool", list(CONSUMERS))
def test_noise_grows_in_the_consumer_as_in_the_model(tool, sensor):
    values = {key: numbers[0] for key, numbers in export(sensor, tool, Options(horizon=T)).values.items()}
    for (n, k), step in zip((GYRO, ACCEL), CONSUMERS[tool](values), strict=True):
        true = [math.sqrt(white_variance(n, T, times) + walk_variance(k, T, times)) for times in (1, 2, 3)]
        assert grown(*step) == pytest.approx(true, rel=0.02), (tool, n)


def test_a_ros_covariance_is_the_variance_of_a_sample(sensor):
    values = export(sensor, "ros").values["angular_velocity_covariance"]
    rng = np.random.default_rng(0)
    drawn = WhiteNoise(GYRO[0]).sample(20_000, 1 / RATE, rng)
    assert values[::4] == pytest.approx([np.var(drawn)] * 3, rel=0.05)
    assert [v for i, v in enumerate(values) if i % 4] == [0] * 6

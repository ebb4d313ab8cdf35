"""Drives for the filter's tests, and the textbook in plain numpy: error states, transition matrices, residuals."""

from types import SimpleNamespace

import numpy as np

from imuwb.log import AXES
from imuwb.navigation.alignment import align
from imuwb.navigation.corrections import corrections_of
from imuwb.navigation.filter_model import FilterModel, Settings
from imuwb.navigation.measurement import measurement_of
from imuwb.navigation.standstill import standstills
from imuwb.navigation.strapdown import mechanize, navigation_state
from imuwb.simulation import Receiver, drive, mixed_route, preset
from imuwb.stochastic import (
    Autoregressive,
    AxisModel,
    Constant,
    GaussMarkov,
    ImuErrorModel,
    RandomWalk,
    Sum,
    WhiteNoise,
)

from .. import ecef  # noqa: TID252 - tests are no package that has a name

E2 = 1 - (ecef.B / ecef.A) ** 2
HZ = 100


def radii(latitude):
    """Return the meridian and the transverse radius, m."""
    root = np.sqrt(1 - E2 * np.sin(latitude) ** 2)
    return ecef.A * (1 - E2) / root**3, ecef.A / root


def scale(position):
    """Return (3,) m of a radian of latitude, one of longitude, and a metre up."""
    meridian, transverse = radii(position[0])
    return np.array([meridian + position[2], (transverse + position[2]) * np.cos(position[0]), -1.0])


def cross(v):
    """Return [v x]."""
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def rotation(q):
    """Return C_b_n of a quaternion (w, x, y, z), by Rodrigues' formula of its vector."""
    s = cross(q[1:4])
    return np.eye(3) + 2 * q[0] * s + 2 * s @ s


def increments(route, seconds, rate=HZ, begin=0.0):
    """Return a noise-free drive from a second on: start state, steps, true state at the end of each."""
    first, n = round(begin * rate), round(seconds * rate)
    omega, force = (x[first + 1 :] for x in route.averages(first + n + 1, rate))
    truth = route.state(begin + np.arange(n + 1) / rate)
    start = navigation_state(truth.position[0], truth.velocity[0], truth.attitude[0])
    return SimpleNamespace(
        start=start, h=np.full(n, 1 / rate), angle=omega / rate, push=force / rate, truth=truth,
        places=truth.position[1:], speeds=truth.velocity[1:], euler=truth.attitude[1:],
    )  # fmt: skip


def went(motion, **other):
    """Return where an IMU goes, some of its input replaced."""
    x = {**vars(motion), **other}
    return mechanize(x["start"], x["h"], x["angle"], x["push"])


def errors(estimate, truth):
    """Return (9,) error states of two tracks' rows: estimate less truth, and C_true = (I + [phi x]) C_estimate."""
    turn = rotation(truth[6:10]) @ rotation(estimate[6:10]).T
    phi = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]) / 2
    return np.concatenate([(estimate[:3] - truth[:3]) * scale(truth[:3]), estimate[3:6] - truth[3:6], phi])


def earth(position, velocity):
    """Return omega_ie and omega_en, NED."""
    meridian, transverse = radii(position[0])
    to_east = velocity[1] / (transverse + position[2])
    still = ecef.RATE * np.array([np.cos(position[0]), 0, -np.sin(position[0])])
    return still, np.array([to_east, -velocity[0] / (meridian + position[2]), -to_east * np.tan(position[0])])


def dynamics(force, still, transport, g=9.81):
    """Return F (9, 9) of navigation's error states, as in ``covariance``; force in NED."""
    f = np.zeros((9, 9))
    f[:3, 3:6] = np.eye(3)
    f[3:6, 6:] = cross(force)
    f[3:6, 3:6] = -cross(2 * still + transport)
    f[5, 2] = 2 * g / ecef.A
    f[6:, 6:] = -cross(still + transport)
    f[6, 4], f[7, 3] = 1 / ecef.A, -1 / ecef.A
    return f


def entry(c):
    """Return G (9, 6): where the sensors' errors come in."""
    g = np.zeros((9, 6))
    g[6:, :3], g[3:6, 3:] = -c, c
    return g


def exponential(f, t):
    """Return e^(F t), and its integral from 0 to t, by their series; |F t| is small."""
    whole, integral, term = np.eye(len(f)), t * np.eye(len(f)), np.eye(len(f))
    for k in range(1, 9):
        term = term @ f * (t / k)
        whole = whole + term
        integral = integral + term * (t / (k + 1))
    return whole, integral


def discrete(f, g, density, h):
    """Return the transition, what an input held over h leads to, and white noise's covariance, by quadrature."""
    phi, integral = exponential(f, h)
    nodes, weights = np.polynomial.legendre.leggauss(4)
    noise = np.zeros_like(f)
    for x, w in zip(nodes, weights, strict=True):
        at = exponential(f, h * (x + 1) / 2)[0] @ g
        noise += h / 2 * w * (at * density) @ at.T
    return phi, integral @ g, noise


#: per axis, orders 0, 1, 3, 2, 4 and 2: densities and sigmas as of a cheap sensor, enlarged to show within 30 s
ALPHA = {
    "gyro_z": ((-2.6, 2.3, -0.69), 2e-5), "accel_x": ((-1.5, 0.51), 3e-4), "accel_y": ((-3.2, 3.9, -2.15, 0.451), 2e-4),
}  # fmt: skip
WHITE = np.array([3e-4, 2e-4, 4e-4, 2e-3, 3e-3, 1e-3])  # rad/s/√Hz, m/s²/√Hz
MARKOV = {"gyro_y": (5e-4, 20.0), "accel_z": (0.02, 50.0)}
WALK = {"accel_z": 2e-3}


def mixed(**settings):
    """Return a filter whose axes have orders 0, 1, 3, 2, 4, 2."""
    axes = {}
    for axis, white in zip(AXES, WHITE, strict=True):
        terms = [WhiteNoise(white)]
        terms += [GaussMarkov(*MARKOV[axis])] if axis in MARKOV else []
        terms += [RandomWalk(WALK[axis])] if axis in WALK else []
        terms += [Autoregressive(*ALPHA[axis], 1 / HZ)] if axis in ALPHA else []
        axes[axis] = AxisModel(Sum(tuple(terms)))
    return FilterModel("mixed", ImuErrorModel("mixed", axes), settings=Settings(**settings))


def plain(constants=(2e-3, 0.03)):
    """Return an error model of white noise, a Gauss-Markov process and a bias per axis."""
    gm = preset("3dm-gx3-25-gm")
    return ImuErrorModel(
        "plain",
        {a: AxisModel(Sum((*gm.axes[a].processes.terms[:2], Constant(constants[a[0] == "a"])))) for a in AXES},
    )


def prepared(model, route=None, seed=1, *, log=None, **options):
    """Return a drive, and what a filter takes of it."""
    log = log or drive(model.error_model, route or mixed_route(240), seed, receiver=Receiver(), **options)
    measurement = measurement_of(log, log.imu(), model.installation)
    stills = standstills(measurement, log, log.gnss[0])
    found = corrections_of(log, log.gnss[0], measurement, stills, model)
    return SimpleNamespace(
        log=log,
        measurement=measurement,
        stills=stills,
        corrections=found,
        alignment=align(measurement, found, stills, model),
    )

"""The vertical profile of a road, as random as ISO 8608 classifies it, under the left and the right wheels.

The density of the elevation at the spatial frequency n (1/m, one-sided) is G_d(n) = G_d(n0) (n0 / n)², n0 = 0.1 1/m. Below
0.011 1/m, where ISO 8608 ends, it stays finite: G_d(n0) n0² / (n² + 0.011²), a first-order Gauss-Markov process of the
distance. Both tracks have this density; their coherence is p² / (n² + p²), p = 0.2 / (track width): a wave that is longer than the
track is wide lifts both wheels.
"""

import math

import numpy as np
from scipy import ndimage, signal

from imuwb.arrays import Floats

#: class -> G_d(n0), m³, the geometric mean of the class (ISO 8608)
CLASSES = {"A": 16e-6, "B": 64e-6, "C": 256e-6, "D": 1024e-6, "E": 4096e-6}
N0 = 0.1  #: 1/m
LOWEST = 0.011  #: 1/m
STEP = 0.05  #: m between the points of a profile
CONTACT = (
    5  #: points over which a tyre averages the profile: 0.25 m, as in the International Roughness Index (Sayers 1995)
)
WARM = 200.0  #: m before the start, in which the filters settle
COHERENT = 0.2  #: p times the track width


def tracks(density: float, length: float, track: float, rng: np.random.Generator) -> Floats:
    """Return the elevation under the left and the right wheels, up, in steps of ``STEP``.

    Args:
        density: G_d(n0), m³.
        length: m.
        track: m, between the left and the right wheels.
        rng: for all draws.

    Returns:
        (n, 2) m, without the tyre's averaging.
    """
    count, warm = math.ceil(length / STEP) + 1, round(WARM / STEP)
    factor = math.exp(-2 * math.pi * LOWEST * STEP)
    sigma = N0 * math.sqrt(math.pi * density / (2 * LOWEST))
    noise = sigma * rng.standard_normal((warm + count, 2))
    noise[1:] *= math.sqrt(1 - factor**2)
    same, apart = signal.lfilter([1.0], [1.0, -factor], noise, axis=0).T
    # |A|² + |B|² = 1 and |A|² - |B|² = p² / (n² + p²), with A = (s/√2 + p) / (s + p) and B = s/√2 / (s + p).
    p, share = 2 * math.pi * COHERENT / track, math.sqrt(0.5)
    both = signal.lfilter(*signal.bilinear([share, p], [1.0, p], 1 / STEP), same)
    half = signal.lfilter(*signal.bilinear([share, 0.0], [1.0, p], 1 / STEP), apart)
    return np.stack([both + half, both - half], axis=1)[warm:]


def under_tyre(profile: Floats) -> Floats:
    """Return a profile as a tyre follows it: averaged over the length of its contact, (n, 2) m."""
    return ndimage.uniform_filter1d(profile, CONTACT, axis=0, mode="nearest")

"""A small algebra of stochastic processes, and the error model of an IMU that is made of them.

``WhiteNoise(N) + GaussMarkov(sigma, T) + RandomWalk(K)`` is a value: it has an Allan variance and a
spectrum, it can be sampled, and it can be given to a filter.
"""

import lazy_loader

# The public names are in __init__.pyi; each is imported when it is first used.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

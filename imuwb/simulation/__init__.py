"""Simulated logs with known truth: the output of a sensor with a given error model."""

import lazy_loader

# The public names are in __init__.pyi; each is imported when it is first used.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

"""Tests of plugins: the contract that analyses, conditioners and readers keep, as rules that a test or ``imuwb plugins check`` asks."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

"""The files of estimators and simulators: an error model out to each, and in from each, by tables of their fields."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

"""Bias removal: takes the mean off each axis, of the whole record or of its first seconds."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__, submod_attrs={"parameters": ["ORDER", "Parameters"], "apply": ["condition"]}
)

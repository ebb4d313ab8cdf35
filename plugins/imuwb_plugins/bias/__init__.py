"""Bias removal: subtracts from each axis its mean over the whole record or its first seconds."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__, submod_attrs={"parameters": ["ORDER", "Parameters"], "apply": ["condition"]}
)

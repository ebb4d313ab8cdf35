"""Correction: removes an error model's bias, scale factors, cross-couplings and g-sensitivity from the samples."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__, submod_attrs={"parameters": ["Parameters"], "apply": ["condition", "draw"]}
)

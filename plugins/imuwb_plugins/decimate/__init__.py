"""Decimation to a lower rate: after a Kaiser low-pass against aliasing, or by leaving samples out."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__, submod_attrs={"parameters": ["ORDER", "STUDY", "Parameters"], "apply": ["condition"]}
)

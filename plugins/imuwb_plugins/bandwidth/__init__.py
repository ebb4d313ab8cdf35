"""Low-pass of a sensor: Butterworth, or a moving average. Causal, with its delay."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__, submod_attrs={"parameters": ["ORDER", "STUDY", "Parameters"], "apply": ["condition", "draw"]}
)

"""Wavelet denoising: SURE, universal or Bayes thresholds, of the whole record or in a sliding window."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__, submod_attrs={"parameters": ["ORDER", "Parameters"], "apply": ["condition", "draw"]}
)
